//! Smooths one mesh and shows the run to the user.

use crate::error::{CliError, ErrorKind};
use crate::load::LoadedMesh;
use std::path::{Path, PathBuf};

use gpu_smooth::{Outcome, Phase, Progress, Smoother};
use mesh_io::atomic;
use serde::Serialize;
use serde_json::json;

use crate::args::OutputArgs;
use crate::args::SmoothArgs;
use crate::load::streams;
use crate::render::html;
use crate::render::picture::{self, Shot};
use crate::report::Failure;
use crate::report::{Done, Task};
use crate::report::{Refusal, Report};
use crate::request::Outputs;
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
    let outputs = Outputs::of_run(args)?;
    let mesh: &[PathBuf] = if streams::is_standard(out) { &[] } else { std::slice::from_ref(out) };
    outputs.check(std::slice::from_ref(input), mesh)?;
    interrupt::watch(show.quiet);
    let resumed = checkpoint::resumed(args)?;
    let resumed = resumed.as_ref();
    let task = Task { args, outputs: &outputs, show, input, out, resumed };
    let display = Display::new(show, args.estimated_end(), args.max_sweeps);
    let mut follow = Shown { outputs: &outputs, show, out, display: &display };
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
    done.map_err(|failure| told_with_report(&outputs, failure))
}

/// Shows a run on the terminal.
struct Shown<'a> {
    outputs: &'a Outputs,
    show: &'a OutputArgs,
    out: &'a Path,
    display: &'a Display,
}

impl Follow for Shown<'_> {
    fn stage(&mut self, stage: Stage) {
        self.display.stage(stage);
    }

    fn has_read(&mut self, file: &LoadedMesh) -> Result<(), CliError> {
        let written = streams::destinations(file, self.out)?;
        self.outputs.check_files(&file.paths(), &written, ErrorKind::Output)
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
        self.outputs.check_report()
    }
}

/// Writes and prints the results of a run that were asked for.
fn finish(task: &Task<'_>, done: &Done<'_>) -> Result<(), CliError> {
    let Task { args, outputs, show, out, .. } = *task;
    let Done { file, smoother, outcome, report, .. } = done;
    write_report(outputs, report)
        .and_then(|()| draw(task, file, smoother, outcome))
        .and_then(|()| html::write(outputs.page.as_deref(), task, done))
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
fn told_with_report(outputs: &Outputs, Failure { error, triangles }: Failure) -> CliError {
    if triangles.is_empty() {
        return error;
    }
    match write_report(outputs, &Refusal { error: error.headline(), triangles }) {
        Ok(()) => error,
        Err(problem) => error.with_detail(problem.to_string()),
    }
}

/// Draws the mesh before and after the run, if a picture was asked for.
fn draw(
    task: &Task<'_>,
    file: &LoadedMesh,
    smoother: &Smoother<'_>,
    outcome: &Outcome,
) -> Result<(), CliError> {
    let shot = |title: &str, points| Shot { title: title.to_owned(), points };
    let shots = [shot("before", &file.mesh().points[..]), shot("after", &outcome.points[..])];
    let surface = task.args.target.surface();
    picture::write(task.outputs.picture.as_ref(), file, (smoother.topology(), surface), &shots)
}

fn write_report(outputs: &Outputs, report: &impl Serialize) -> Result<(), CliError> {
    let Some(path) = &outputs.report else { return Ok(()) };
    let mut text = serde_json::to_string_pretty(report)?;
    text.push('\n');
    atomic::replace(path, text.as_bytes())
        .map_err(|error| CliError::from(error).within("the report was not written"))
}
