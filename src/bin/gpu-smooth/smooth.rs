//! `gpu-smooth IN OUT`.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use gpu_smooth::{Backend, Mesh, MeshFile, Outcome, SmoothError, Smoother, Stop};

use crate::cli::{History, SmoothArgs};
use crate::engine;
use crate::explain;
use crate::progress::Bar;
use crate::report::{self, EngineReport, GoalReport, MeshReport, Report, Seconds};
use crate::tell;

/// Reads a mesh.
pub(crate) fn read(path: &Path) -> Result<MeshFile, String> {
    MeshFile::read(path).map_err(|error| error.to_string())
}

pub(crate) fn run(args: &SmoothArgs) -> Result<(), String> {
    let (Some(input), Some(output)) = (&args.input, &args.output) else {
        return Err("IN and OUT are needed".into());
    };
    let start = Instant::now();
    // The driver takes as long to start as a mesh to read: both at once.
    std::thread::scope(|scope| {
        let backend = scope.spawn(|| engine::open(args));
        let file = read(input)?;
        let read_done = Instant::now();
        check_destinations(args, &file, output)?;
        for remark in file.notes() {
            tell::note(args.quiet, remark);
        }
        let mesh = file.mesh();
        let smoother = Smoother::new(mesh).map_err(|error| explain::mesh_error(&file, &error))?;
        let (backend, remark) =
            backend.join().map_err(|_| "the graphics driver crashed on start".to_owned())??;
        remark.iter().for_each(|remark| tell::note(args.quiet, remark));
        let before = smoother.quality(&mesh.points);
        let prepared = Instant::now();

        let (outcome, backend) = smooth(args, &smoother, backend)?;
        let mut points = outcome.points.clone();
        points.iter_mut().flatten().for_each(|x| *x = file.stored(*x));
        let returned = outcome.returned + smoother.certify(&mut points);
        let after = smoother.quality(&points);
        let smoothed = Instant::now();

        file.write(output, &points).map_err(|error| error.to_string())?;
        let written = Instant::now();

        let seconds = Seconds {
            read: (read_done - start).as_secs_f64(),
            prepare: (prepared - read_done).as_secs_f64(),
            smooth: (smoothed - prepared).as_secs_f64(),
            write: (written - smoothed).as_secs_f64(),
            total: (written - start).as_secs_f64(),
        };
        let report = Report {
            engine: engine_report(&backend),
            mesh: mesh_report(&file, mesh, &smoother),
            scheme: args.scheme.to_string(),
            sweeps: outcome.sweeps,
            corrections: outcome.corrections,
            opening_sweeps: outcome.opening_sweeps,
            levels_left_out: outcome.levels_left_out,
            best_sweep: outcome.best_sweep,
            stop: outcome.stop.name(),
            goal: goal_report(&outcome),
            returned,
            before: (&before).into(),
            after: (&after).into(),
            history: report::history(&outcome, &args.scheme, args.history == History::All),
            seconds,
        };
        write_report(args, &report)?;
        if args.verbose {
            for sweep in &report.history {
                let metric = sweep.metric.unwrap_or("-");
                tell::say(&format!("sweep {:<5} {metric:<5} f {:.10}", sweep.sweep, sweep.f));
            }
        }
        if !args.quiet {
            tell::say(&report.summary());
        }
        Ok(())
    })
}

/// Smooths, on the CPU if the GPU cannot hold the mesh and the user left the choice.
fn smooth(
    args: &SmoothArgs,
    smoother: &Smoother<'_>,
    backend: Backend,
) -> Result<(Outcome, Backend), String> {
    let options = args.options();
    let mut bar = Bar::new(args.quiet, args.max_sweeps);
    let mut observe = |progress: &gpu_smooth::Progress| {
        bar.update(progress);
        ControlFlow::Continue(())
    };
    let outcome = match smoother.run(&options, &backend, &mut observe) {
        Err(error) if engine::may_fall_back(args, &error) => {
            let outcome = smoother.run(&options, &Backend::Cpu, &mut observe);
            outcome.map(|outcome| (outcome, Backend::Cpu))
        }
        done => done.map(|outcome| (outcome, backend)),
    };
    bar.clear();
    outcome.map_err(|error: SmoothError| match engine::is_too_large(&error) {
        true => format!("{error}. Smooth on the CPU: --engine cpu"),
        false => error.to_string(),
    })
}

/// Refuses before the work what would fail after it.
fn check_destinations(args: &SmoothArgs, file: &MeshFile, output: &Path) -> Result<(), String> {
    file.check_destination(output).map_err(|error| error.to_string())?;
    let Some(report) = &args.report else { return Ok(()) };
    let is_mesh = ["node", "ele", "poly", "msh"]
        .iter()
        .any(|ending| report.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending)));
    if is_mesh || report == output || report == file.path() {
        let name = report.display();
        return Err(format!("{name}: the report is JSON, not a mesh. End its name in .json"));
    }
    let directory = match report.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    if report.is_dir() || !directory.is_dir() {
        let name = report.display();
        return Err(format!(
            "{name}: the report cannot be written there. Name a file in a directory that exists"
        ));
    }
    Ok(())
}

fn write_report(args: &SmoothArgs, report: &Report) -> Result<(), String> {
    let Some(path) = &args.report else { return Ok(()) };
    let mut text = serde_json::to_string_pretty(report).map_err(|error| error.to_string())?;
    text.push('\n');
    fs::write(path, text).map_err(|error| {
        format!("{}: the report was not written: {error}. The mesh was", path.display())
    })
}

fn engine_report(backend: &Backend) -> EngineReport {
    match backend {
        Backend::Cpu => EngineReport { kind: "cpu", adapter: None, driver: None },
        Backend::Gpu(gpu) => EngineReport {
            kind: "gpu",
            adapter: Some(gpu.adapter().name.clone()),
            driver: Some(gpu.adapter().driver.clone()),
        },
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
