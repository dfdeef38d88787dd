//! `gpu-smooth IN OUT`.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use gpu_smooth::{
    Backend, Mesh, MeshError, MeshFile, MeshSize, Options, Outcome, Phase, Precision, Progress,
    SmoothError, Smoother, Stop, output,
};
use serde::Serialize;

use crate::cli::{History, OutputArgs, SmoothArgs};
use crate::engine::{self, Taken};
use crate::explain;
use crate::interrupt;
use crate::moving::Choice;
use crate::picture::{self, Shot};
use crate::progress::Bar;
use crate::report::{
    self, EngineReport, GoalReport, MeshReport, Refusal, Report, Seconds, UntangleReport,
};
use crate::streams::{self, is_standard};
use crate::tell;
use crate::untangle;

pub(crate) use crate::streams::read;

pub(crate) fn run(args: &SmoothArgs, show: &OutputArgs) -> Result<(), String> {
    let (Some(input), Some(out)) = (&args.input, &args.output) else {
        return Err("IN and OUT are needed".into());
    };
    let start = Instant::now();
    interrupt::watch(show.quiet);
    // The driver starts while the mesh is read, or while it is prepared if its size decides on the engine.
    std::thread::scope(|scope| {
        let opening = (!engine::is_open(args)).then(|| scope.spawn(|| engine::open(args)));
        let mut file = read(input)?;
        let choice = args.moving.apply(&mut file)?;
        let mut riding = args.riding.choose(&file)?;
        let file = file;
        let read_done = Instant::now();
        check_destinations(args, &file, out)?;
        for remark in tell::remarks(&file).iter().chain(&choice.notes) {
            tell::note(show.quiet, remark);
        }
        let mesh = file.mesh();
        let size = MeshSize { vertices: mesh.points.len(), triangles: mesh.triangles.len() };
        let opening =
            opening.unwrap_or_else(|| scope.spawn(move || Ok(engine::choose(args, size))));
        let mended;
        let (smoother, mending) = match Smoother::new(mesh) {
            Ok(smoother) => (smoother, None),
            Err(error) if args.untangle && untangle::can_mend(&error) => {
                riding.check_untangled()?;
                mended = untangle::mend(args, show, &file, out)?;
                let smoother = Smoother::new(&mended.mesh);
                let smoother = smoother.map_err(|error| explain::mesh_error(&file, &error))?;
                (smoother, Some(&mended))
            }
            Err(error) => return Err(refusal(args, &choice, &file, &error)),
        };
        let taken =
            opening.join().map_err(|_| "the graphics driver crashed on start".to_owned())??;
        let before = smoother.quality(&mesh.points).map_err(told)?;
        let prepared = Instant::now();

        let options = options(args, &choice, file.precision());
        let (outcome, taken) = smooth(args, &options, show, &smoother, &file, taken)?;
        interrupt::has_result();
        let after = smoother.quality(&outcome.points).map_err(told)?;
        let interpolated = riding.carry(&file, smoother.topology(), &outcome.points)?;
        let parameters = riding.add_parameters(&file, &outcome.points)?;
        let has_moved = outcome.points != mesh.points;
        let left_behind = has_moved.then(|| riding.left_behind(&file)).flatten();
        let parameters = parameters.filter(|_| has_moved);
        for note in interpolated.iter().chain(&left_behind).chain(&parameters) {
            tell::note(show.quiet, note);
        }
        let smoothed = Instant::now();

        // The destination may have changed during a long run.
        check_report(args)?;
        streams::write(&file, out, &outcome.points, riding.fields())?;
        let written = Instant::now();

        let seconds = Seconds {
            read: (read_done - start).as_secs_f64(),
            prepare: (prepared - read_done).as_secs_f64(),
            smooth: (smoothed - prepared).as_secs_f64(),
            write: (written - smoothed).as_secs_f64(),
            total: (written - start).as_secs_f64(),
        };
        let report = Report {
            engine: engine_report(&taken),
            mesh: mesh_report(&file, mesh, &smoother),
            untangled: mending.map(|mended| UntangleReport {
                bad_before: mended.bad_before,
                sweeps: mended.sweeps,
                moved: mended.moved,
            }),
            scheme: args.scheme.to_string(),
            sweeps: outcome.sweeps,
            corrections: outcome.corrections,
            opening_sweeps: outcome.opening_sweeps,
            levels_left_out: outcome.levels_left_out,
            best_sweep: outcome.best_sweep,
            remaining: outcome.remaining,
            stop: choice.nothing_to_do.as_ref().map_or(outcome.stop.name(), |_| "nothing-to-do"),
            nothing_to_do: choice.nothing_to_do,
            choices: choice.notes,
            interpolated,
            held_back: outcome.held_back,
            lost: outcome.lost,
            goal: goal_report(&outcome),
            returned: outcome.returned,
            before: (&before).into(),
            after: (&after).into(),
            history: report::history(&outcome, &args.scheme, args.history == History::All),
            seconds,
        };
        write_report(args, &report)
            .and_then(|()| draw(args, &file, &smoother, &outcome))
            .map_err(|problem| format!("{problem}. The mesh was written"))?;
        let say = |text: &str| streams::say_beside(out, text);
        if show.verbose {
            for sweep in &report.history {
                let metric = sweep.metric.unwrap_or("-");
                say(&format!("sweep {:<5} {metric:<5} f {:.10}", sweep.sweep, sweep.f));
            }
        }
        if !show.quiet {
            say(&report.summary());
        }
        Ok(())
    })
}

/// The options of the run; of one without sweeps if there is nothing to do.
fn options(args: &SmoothArgs, choice: &Choice, stored: Precision) -> Options {
    let options = args.options(stored);
    match choice.nothing_to_do {
        Some(_) => Options { max_sweeps: 0, goal: None, ..options },
        None => options,
    }
}

/// Smooths. Falls back to the CPU if the GPU cannot hold the mesh and the user left the choice.
fn smooth(
    args: &SmoothArgs,
    options: &Options,
    show: &OutputArgs,
    smoother: &Smoother<'_>,
    file: &MeshFile,
    mut taken: Taken,
) -> Result<(Outcome, Taken), String> {
    let mut bar = Bar::new(show, args.max_sweeps);
    let mut observe = |progress: &Progress| {
        if progress.phase == Phase::Smoothing {
            interrupt::has_result();
        }
        bar.update(progress);
        match interrupt::is_requested() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    };
    let mut outcome = smoother.run(options, &taken.backend, &mut observe);
    if let Err(error) = &outcome
        && engine::is_open(args)
        && engine::is_too_large(error)
    {
        taken = Taken { backend: Backend::Cpu, reason: Some(error.to_string()) };
        outcome = smoother.run(options, &taken.backend, &mut observe);
    }
    bar.clear();
    if interrupt::is_requested() {
        let text = "interrupted: writing the best mesh so far (once more to end without it)";
        tell::note(show.quiet, text);
    }
    let outcome = outcome.map(|outcome| (outcome, taken));
    outcome.map_err(|error: SmoothError| match &error {
        SmoothError::Mesh(error) => explain::mesh_error(file, error),
        error if engine::is_too_large(error) => {
            format!("{error}. Smooth on the CPU: --engine cpu")
        }
        error => error.to_string(),
    })
}

/// Refuses destinations that cannot be written before the work is done.
fn check_destinations(args: &SmoothArgs, file: &MeshFile, out: &Path) -> Result<(), String> {
    let written = match is_standard(out) {
        true if file.paths().count() > 1 => {
            return Err("a Triangle mesh is of several files: name OUT".into());
        }
        true => Vec::new(),
        false => {
            file.check_destination(out).map_err(told)?;
            file.destinations(out).map_err(told)?
        }
    };
    let of_meshes = || file.paths().chain(written.iter().map(PathBuf::as_path));
    let report = args.report.as_deref();
    picture::check(&args.picture, of_meshes().chain(report))?;
    let Some(report) = report else { return Ok(()) };
    let is_mesh = ["node", "ele", "poly", "msh"]
        .iter()
        .any(|ending| report.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending)));
    if is_mesh || of_meshes().any(|path| output::same_file(path, report)) {
        let name = report.display();
        return Err(format!("{name}: the report is JSON, not a mesh. End its name in .json"));
    }
    check_report(args)
}

fn check_report(args: &SmoothArgs) -> Result<(), String> {
    let Some(report) = &args.report else { return Ok(()) };
    output::check(report).map_err(|error| format!("the report cannot be written: {error}"))
}

/// Why a mesh is not smoothed. Where triangles are inverted or flat, the report that was asked for lists all of them.
fn refusal(args: &SmoothArgs, choice: &Choice, file: &MeshFile, error: &MeshError) -> String {
    if let Some(message) = choice.nothing_free(file, error) {
        return message;
    }
    let message = explain::mesh_error(file, error);
    let MeshError::Infeasible { triangles } = error else { return message };
    if args.report.is_none() {
        return message;
    }
    let triangles = explain::bad_triangles(file, triangles);
    let first_line = message.lines().next().unwrap_or_default().to_owned();
    match write_report(args, &Refusal { error: first_line, triangles }) {
        Ok(()) => message,
        Err(problem) => format!("{message}\n  {problem}"),
    }
}

/// Draws the picture that was asked for: before and after.
fn draw(
    args: &SmoothArgs,
    file: &MeshFile,
    smoother: &Smoother<'_>,
    outcome: &Outcome,
) -> Result<(), String> {
    let shot = |title: &str, points| Shot { title: title.to_owned(), points };
    let shots = [shot("before", &file.mesh().points[..]), shot("after", &outcome.points[..])];
    picture::write(&args.picture, file, smoother.topology(), &shots)
}

fn told(error: impl std::error::Error) -> String {
    error.to_string()
}

fn write_report(args: &SmoothArgs, report: &impl Serialize) -> Result<(), String> {
    let Some(path) = &args.report else { return Ok(()) };
    let mut text = serde_json::to_string_pretty(report).map_err(told)?;
    text.push('\n');
    output::replace(path, text.as_bytes())
        .map_err(|error| format!("the report was not written: {error}"))
}

fn engine_report(taken: &Taken) -> EngineReport {
    let adapter = match &taken.backend {
        Backend::Cpu => None,
        Backend::Gpu(gpu) => Some(gpu.adapter()),
    };
    EngineReport {
        kind: if adapter.is_some() { "gpu" } else { "cpu" },
        adapter: adapter.map(|adapter| adapter.name.clone()),
        driver: adapter.map(|adapter| adapter.driver.clone()),
        reason: taken.reason.clone(),
    }
}

fn mesh_report(file: &MeshFile, mesh: &Mesh, smoother: &Smoother<'_>) -> MeshReport {
    MeshReport {
        format: file.format().to_string(),
        vertices: mesh.points.len(),
        triangles: mesh.triangles.len(),
        free: smoother.topology().free_count(),
        colors: smoother.colors(),
    }
}

fn goal_report(outcome: &Outcome) -> Option<GoalReport> {
    outcome.goal.as_ref().map(|goal| GoalReport {
        fraction: goal.fraction,
        desired: goal.desired,
        origin: goal.origin.clone(),
        reached: outcome.stop == Stop::Reached,
        best_fraction: goal.best_fraction,
    })
}
