//! Smooths one mesh and shows the run to the user.

use crate::error::CliError;
use crate::load::LoadedMesh;
use std::path::Path;

use gpu_smooth::{Outcome, Phase, Progress, Smoother};
use mesh_io::atomic;
use serde::Serialize;
use serde_json::json;

use crate::args::OutputArgs;
use crate::args::SmoothArgs;
use crate::commands::smooth::destinations;
use crate::load::streams;
use crate::render::html;
use crate::render::picture::{self, Shot};
use crate::report::Failure;
use crate::report::{Done, Task};
use crate::report::{Refusal, Report};
use crate::run::carry_out;
use crate::run::checkpoint;
use crate::run::engine;
use crate::run::observer::Follow;
use crate::terminal::interrupt;
use crate::terminal::progress::{Display, Stage};
use crate::terminal::tell;

pub(crate) fn run(args: &SmoothArgs, show: &OutputArgs) -> Result<(), CliError> {
    let (Some(input), Some(out)) = (&args.input, &args.output) else {
        return Err(CliError::usage("IN and OUT are needed"));
    };
    interrupt::watch(show.quiet);
    let resumed = checkpoint::resumed(args)?;
    let resumed = resumed.as_ref();
    let task = Task { args, show, input, out, resumed };
    let display = Display::new(show, args.estimated_end(), args.max_sweeps);
    let mut follow = Shown { args, show, out, display: &display };
    // The driver starts while the mesh is read. If the size of the mesh decides on the engine, it starts while the mesh
    // is prepared.
    let done = std::thread::scope(|scope| {
        let opening = (!engine::is_open(args)).then(|| scope.spawn(|| engine::open(args)));
        let engine = move |size| match opening {
            Some(opening) => opening.join().map_err(|_| engine::driver_crashed())?,
            None => Ok(match resumed {
                Some(checkpoint) => engine::of_checkpoint(checkpoint),
                None => engine::choose(args, size),
            }),
        };
        carry_out(&task, engine, &mut follow, |done| {
            display.clear();
            finish(&task, &done)
        })
    });
    display.clear();
    done.map_err(|failure| told_with_report(args, failure))
}

/// Shows a run on the terminal.
struct Shown<'a> {
    args: &'a SmoothArgs,
    show: &'a OutputArgs,
    out: &'a Path,
    display: &'a Display,
}

impl Follow for Shown<'_> {
    fn stage(&mut self, stage: Stage) {
        self.display.stage(stage);
    }

    fn has_read(&mut self, file: &LoadedMesh) -> Result<(), CliError> {
        destinations::check(self.args, file, self.out)
    }

    fn remark(&mut self, text: &str) {
        self.display.aside(|| tell::note(self.show.quiet, text));
    }

    fn sweep(&mut self, progress: &Progress) {
        if progress.phase == Phase::Smoothing {
            interrupt::has_result();
        }
        self.display.sweep(progress);
    }

    fn has_smoothed(&mut self) -> Result<(), CliError> {
        if interrupt::is_requested() {
            let text =
                "interrupted: writing the best mesh so far (interrupt again to end without it)";
            self.display.aside(|| tell::note(self.show.quiet, text));
        }
        interrupt::has_result();
        destinations::can_write_report(self.args)
    }
}

/// Writes and prints the results of a run that were asked for.
fn finish(task: &Task<'_>, done: &Done<'_>) -> Result<(), CliError> {
    let Task { args, show, out, .. } = *task;
    let Done { file, smoother, outcome, report, .. } = done;
    write_report(args, report)
        .and_then(|()| draw(args, file, smoother, outcome))
        .and_then(|()| html::write(args.html.as_deref(), task, done))
        .map_err(|error| error.followed_by("The mesh was written"))?;
    let say = |text: &str| streams::say_beside(out, text);
    if show.verbose {
        sweeps(report).for_each(|line| say(&line));
    }
    if !show.quiet {
        say(&report.summary());
        if tell::is_json() {
            let (before, after) = (report.before.f[report.base()], report.after.f[report.base()]);
            tell::event(json!({
                "event": "end", "mesh": task.input.display().to_string(), "stop": report.stop,
                "sweeps": report.sweeps, "f_before": before, "f_after": after,
            }));
        }
    }
    match report.fell_short().filter(|_| args.strict) {
        None => Ok(()),
        Some(ending) => {
            let text = format!("{ending}. The mesh was written; --strict makes this an error");
            Err(CliError::run(text))
        }
    }
}

/// Writes a line for each sweep.
fn sweeps(report: &Report) -> impl Iterator<Item = String> + '_ {
    report.history.iter().map(|sweep| {
        let metric = sweep.metric.unwrap_or("-");
        format!("sweep {:<5} {metric:<5} f {:.10}", sweep.sweep, sweep.f)
    })
}

/// Returns the error why a mesh is not smoothed. If triangles are inverted or flat, also lists all of them in the
/// report that was asked for.
fn told_with_report(args: &SmoothArgs, Failure { error, triangles }: Failure) -> CliError {
    if triangles.is_empty() {
        return error;
    }
    match write_report(args, &Refusal { error: error.headline(), triangles }) {
        Ok(()) => error,
        Err(problem) => error.with_detail(problem.to_string()),
    }
}

/// Draws the mesh before and after the run, if a picture was asked for.
fn draw(
    args: &SmoothArgs,
    file: &LoadedMesh,
    smoother: &Smoother<'_>,
    outcome: &Outcome,
) -> Result<(), CliError> {
    let shot = |title: &str, points| Shot { title: title.to_owned(), points };
    let shots = [shot("before", &file.mesh().points[..]), shot("after", &outcome.points[..])];
    let surface = args.target.surface();
    picture::write(&args.picture, file, (smoother.topology(), surface), &shots)
}

fn write_report(args: &SmoothArgs, report: &impl Serialize) -> Result<(), CliError> {
    let Some(path) = &args.report else { return Ok(()) };
    let mut text = serde_json::to_string_pretty(report)?;
    text.push('\n');
    atomic::replace(path, text.as_bytes())
        .map_err(|error| CliError::from(error).within("the report was not written"))
}
