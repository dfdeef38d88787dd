//! The run on one mesh, with progress and results on the terminal.

use crate::error::CliError;
use crate::load::LoadedMesh;
use std::path::{Path, PathBuf};
use std::slice;
use std::time::Instant;

use gpu_smooth::{Outcome, Phase, Progress, Smoother};
use mesh_io::{Conversion, atomic};
use serde::Serialize;
use serde_json::json;

use crate::commands::smooth::dry_run;
use crate::load::destination;
use crate::load::streams;
use crate::render::html;
use crate::render::picture::{self, MeshState, PictureSubject};
use crate::report::{Done, SmoothJob};
use crate::report::{Failure, versioned_json};
use crate::report::{Refusal, Report};
use crate::request::{Outputs, RunExtent, SmoothRequest};
use crate::run::checkpoint;
use crate::run::engine;
use crate::run::observer::PipelineObserver;
use crate::run::rehearsal;
use crate::run::run_pipeline;
use crate::terminal::Verbosity;
use crate::terminal::interrupt;
use crate::terminal::progress::{Display, Stage};
use crate::terminal::tell;

/// Smooths a mesh from the file `input` to the file `out`.
pub(crate) fn run(
    request: &SmoothRequest,
    input: &PathBuf,
    out: &PathBuf,
    verbosity: Verbosity,
) -> Result<(), CliError> {
    // From here on, a signal leaves no temporary file behind, neither of a check nor of a write.
    interrupt::watch(verbosity.quiet);
    request.outputs.check(slice::from_ref(input), slice::from_ref(out))?;
    let resumed = checkpoint::resumed(request.continue_from.as_deref())?;
    let resumed = resumed.as_ref();
    let task = SmoothJob { request, verbosity, input, out, resumed };
    let display = Display::new(verbosity, request.estimated_end(), request.max_sweeps());
    let mut follow = Shown { request, verbosity, input, out, display: &display };
    // The driver starts while the mesh is read. If the size of the mesh determines the engine, the driver starts while
    // the mesh is prepared.
    let done = std::thread::scope(|scope| {
        let opening = scope.spawn(|| engine::open(&request.engine));
        let engine = move |size| {
            let opened = opening.join().map_err(|_| engine::driver_crashed())??;
            Ok(opened.unwrap_or_else(|| match resumed {
                Some(checkpoint) => engine::of_checkpoint(checkpoint),
                None => engine::choose(request, size),
            }))
        };
        if request.extent == RunExtent::Prepared {
            let rehearsal = rehearsal::rehearse(&task, engine, &mut follow)?;
            display.clear();
            dry_run::print(&task, &rehearsal);
            return Ok(());
        }
        run_pipeline(&task, engine, &mut follow, |done| finish(&task, done, &display))
    });
    display.clear();
    done.map_err(|failure| match request.extent {
        RunExtent::Whole => error_with_report(&request.outputs, failure),
        RunExtent::Unwritten | RunExtent::Prepared => failure.error,
    })
}

/// Observer that shows a run on the terminal and checks its output files.
struct Shown<'a> {
    request: &'a SmoothRequest,
    verbosity: Verbosity,
    input: &'a Path,
    out: &'a Path,
    display: &'a Display,
}

impl PipelineObserver for Shown<'_> {
    fn stage(&mut self, stage: Stage) {
        self.display.stage(stage);
    }

    fn has_read(
        &mut self,
        file: &LoadedMesh,
        conversion: Option<&Conversion>,
    ) -> Result<(), CliError> {
        let outputs = &self.request.outputs;
        Outputs::check_companion(self.input, self.out, &file.paths())?;
        if let Some(picture) = &outputs.picture {
            picture.check_part(&file.mesh().points)?;
        }
        let bytes = file.source.contents().map(|(_, bytes)| bytes.len() as u64).sum();
        let drawing = drawing_stage(outputs, file.mesh().triangles.len());
        self.display.expect([Stage::Writing { bytes }].into_iter().chain(drawing).collect());
        let remedy = "To smooth several meshes, name a directory by --out-dir; to replace the file all the same, add --force";
        destination::check(self.request, file, self.out, conversion, remedy)
    }

    fn remark(&mut self, text: &str) {
        self.display.aside(|| tell::note(self.verbosity.quiet, text));
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
            self.display.aside(|| tell::note(self.verbosity.quiet, text));
        }
        interrupt::has_result();
        self.request.outputs.check_report()
    }
}

/// Writes and prints the requested results of a run.
fn finish(task: &SmoothJob<'_>, mut done: Done<'_>, display: &Display) -> Result<(), CliError> {
    let SmoothJob { request, verbosity, out, .. } = *task;
    let outputs = &request.outputs;
    let drawn = draw(task, &mut done, display);
    display.clear();
    let report = &done.report;
    // The report contains the time of the drawings, and is written even if they fail.
    write_report(outputs, report)
        .and(drawn)
        .map_err(|error| error.followed_by("The mesh was written"))?;
    let say = |text: &str| streams::say_beside(out, text);
    if verbosity.verbose {
        sweeps(report).for_each(|line| say(&line));
    }
    if !verbosity.quiet {
        say(&report.summary());
        if tell::is_json() {
            let (before, after) = (report.before.f[report.base()], report.after.f[report.base()]);
            tell::event(json!({
                "event": "end", "mesh": task.input.display().to_string(), "stop": report.stop,
                "sweeps": report.sweeps, "f_before": before, "f_after": after,
            }));
        }
    }
    match report.fell_short().filter(|_| request.is_strict) {
        None => Ok(()),
        Some(ending) => {
            let text = format!("{ending}. The mesh was written; --strict makes this an error");
            Err(CliError::run(text))
        }
    }
}

/// Formats a line for each sweep.
fn sweeps(report: &Report) -> impl Iterator<Item = String> + '_ {
    report.history.iter().map(|sweep| {
        let metric = sweep.metric.unwrap_or("-");
        format!("sweep {:<5} {metric:<5} f {:.10}", sweep.sweep, sweep.f)
    })
}

/// Returns the error of a mesh that cannot be smoothed. If inverted or flat triangles are the cause, lists all of them
/// in the requested report.
fn error_with_report(outputs: &Outputs, Failure { error, triangles }: Failure) -> CliError {
    let Some(triangles) = triangles else { return error };
    match write_report(outputs, &Refusal { error: error.headline(), triangles }) {
        Ok(()) => error,
        Err(problem) => error.with_detail(problem.to_string()),
    }
}

/// Returns the stage of the requested drawings; `None` without drawings.
fn drawing_stage(outputs: &Outputs, triangles: usize) -> Option<Stage> {
    let drawings = usize::from(outputs.picture.is_some()) + usize::from(outputs.page.is_some());
    (drawings > 0).then_some(Stage::Drawing { triangles: drawings * triangles })
}

/// Draws the requested picture and page of a run, and adds their time to the report.
fn draw(task: &SmoothJob<'_>, done: &mut Done<'_>, display: &Display) -> Result<(), CliError> {
    let outputs = &task.request.outputs;
    let triangles = done.file.mesh().triangles.len();
    let Some(stage) = drawing_stage(outputs, triangles) else { return Ok(()) };
    display.stage(stage);
    let began = Instant::now();
    let drawn = draw_picture(task, done.file, done.smoother, done.outcome)
        .and_then(|()| html::write(outputs.page.as_deref(), task, done, began));
    done.report.seconds = done.report.seconds.with_pictures(began.elapsed());
    drawn
}

/// Draws the mesh before and after the run if a picture is requested.
fn draw_picture(
    task: &SmoothJob<'_>,
    file: &LoadedMesh,
    smoother: &Smoother<'_>,
    outcome: &Outcome,
) -> Result<(), CliError> {
    let name = task.input.file_name().unwrap_or_default().display();
    let state = |when: &str, points| MeshState { title: format!("{name}, {when}"), points };
    let states = [state("before", &file.mesh().points[..]), state("after", &outcome.points[..])];
    let SmoothRequest { outputs, surface, .. } = task.request;
    let mesh = PictureSubject { file, topology: smoother.topology(), surface: *surface };
    picture::write(outputs.picture.as_ref(), mesh, &states)
}

fn write_report(outputs: &Outputs, report: &impl Serialize) -> Result<(), CliError> {
    let Some(path) = &outputs.report else { return Ok(()) };
    let text = versioned_json(report)?;
    atomic::write(path, text.as_bytes())
        .map_err(|error| CliError::from(error).within("the report was not written"))
}
