//! Construction of a run's report from the results of its stages.

use std::time::Instant;

use gpu_smooth::{Backend, Checkpoint, Metric, Outcome, Smoother, Stop};
use gpu_smooth_job::options::{GivenOptions, Kind};

use crate::report::{
    self, Certificate, EngineReport, FaultReport, GoalReport, MeshReport, Report, Seconds,
    SlideReport, UntangleReport,
};
use crate::request::SmoothRequest;
use crate::run::engine::OpenEngine;
use crate::run::input::Input;
use crate::run::prepare::Ready;
use crate::run::result::Measures;
use crate::run::sweeps::FinishedRun;
use crate::run::untangle::UntangledInput;

/// Times at the start of a run and at the end of each stage.
pub(super) struct Clock {
    pub(super) began: Instant,
    pub(super) read: Instant,
    pub(super) prepared: Instant,
    pub(super) smoothed: Instant,
    pub(super) written: Instant,
}

impl Clock {
    /// Returns the duration of each stage in seconds.
    fn seconds(&self) -> Seconds {
        Seconds {
            read: (self.read - self.began).as_secs_f64(),
            prepare: (self.prepared - self.read).as_secs_f64(),
            smooth: (self.smoothed - self.prepared).as_secs_f64(),
            write: (self.written - self.smoothed).as_secs_f64(),
            pictures: 0.0,
            total: (self.written - self.began).as_secs_f64(),
        }
    }
}

/// Returns the report of a run after its mesh is written.
pub(super) fn report(
    input: &Input<'_>,
    ready: &Ready<'_>,
    ran: &FinishedRun,
    measured: Measures,
    certificate: Option<Certificate>,
    clock: &Clock,
) -> Report {
    let (request, choice, outcome) = (input.request(), input.choice, &ran.outcome);
    Report {
        engine: engine_report(&ran.taken, outcome),
        mesh: mesh_report(input, &ready.smoother),
        target: measured.target,
        untangled: ready.mended.map(untangle_report),
        scheme: request.scheme().to_string(),
        options: options(request),
        sweeps: outcome.sweeps,
        corrections: outcome.corrections,
        newton_steps: outcome.newton_steps,
        newton_iterations: outcome.newton_iterations,
        opening_sweeps: outcome.opening_sweeps,
        closing_sweeps: outcome.closing_sweeps,
        levels_left_out: outcome.levels_left_out,
        best_sweep: outcome.best_sweep,
        movable_f: outcome.movable_f,
        remaining: outcome.remaining,
        imprecise: is_imprecise(input, ran),
        projection_error: projection_error(input, ran),
        stop: stop(input, ran),
        continued_from: input.task.resumed.map(Checkpoint::sweeps),
        nothing_to_do: choice.nothing_to_do.clone(),
        choices: choice.notes.clone(),
        interpolated: measured.interpolated,
        held_back: outcome.held_back,
        guards_worst: request.guards_worst(),
        lost: outcome.lost,
        goal: goal_report(outcome),
        returned: outcome.returned,
        slid: outcome.slid.map(|slid| {
            let (ends, has_weirs) =
                ready.sliding.as_ref().map_or((0, false), |own| (own.ends, own.has_weirs));
            SlideReport { ends, has_weirs, ..slid.into() }
        }),
        floored: outcome.floored.map(Into::into),
        large_angles: outcome.large_angles.map(Into::into),
        improved: outcome.improved.map(Into::into),
        change: measured.change.into(),
        profile: measured.profile,
        spacing: measured.spacing,
        before: (&ready.before).into(),
        after: (&measured.after).into(),
        certificate,
        history: report::history(outcome, request.scheme(), request.tracks_all()),
        seconds: clock.seconds(),
    }
}

/// Returns the options of the table that the command line has, with their values.
fn options(request: &SmoothRequest) -> serde_json::Map<String, serde_json::Value> {
    let value = |name: &str, text: &str| -> serde_json::Value {
        let is_number =
            !GivenOptions::row(name).is_some_and(|row| matches!(row.kind, Kind::Text(_)));
        match (text.parse::<u32>(), text.parse::<f64>()) {
            (Ok(count), _) if is_number => count.into(),
            (_, Ok(number)) if is_number => number.into(),
            _ if text == "true" => true.into(),
            _ => text.into(),
        }
    };
    request.given.values().map(|(name, text)| (name.to_owned(), value(name, text))).collect()
}

/// Multiple of the tolerance that a run reports if bounds or a guard may hold vertices, whatever the precision of the engine.
const HELD: f64 = 2.0;

/// Returns whether a GPU ended the run as converged, although the error of its f exceeds the tolerance.
fn is_imprecise(input: &Input<'_>, ran: &FinishedRun) -> bool {
    let (request, outcome) = (input.request(), &ran.outcome);
    let is_gpu = matches!(&*ran.taken.backend, Backend::Gpu(_));
    // The estimate of EDGE includes a distance that is no error.
    let is_smooth = request.scheme().base() != Metric::Edge;
    let exceeds = |tolerance: f64| {
        let is_of_precision = |left: &f64| {
            *left > tolerance.max(outcome.projection_error) && *left != HELD * tolerance
        };
        outcome.remaining.as_ref().is_some_and(is_of_precision)
    };
    is_gpu
        && is_smooth
        && outcome.closing_sweeps == 0
        && outcome.stop == Stop::Converged
        && request.estimated_end().is_some_and(exceeds)
}

/// Returns the estimated distance between the optima in the projection of the sphere and on the sphere, if the distance
/// exceeds the tolerance.
fn projection_error(input: &Input<'_>, ran: &FinishedRun) -> Option<f64> {
    let tolerance = input.request().estimated_end()?;
    Some(ran.outcome.projection_error).filter(|error| *error > tolerance)
}

/// Returns the name of the reason why a run ended.
fn stop(input: &Input<'_>, ran: &FinishedRun) -> &'static str {
    match input.choice.nothing_to_do {
        Some(_) => "nothing-to-do",
        None if ran.out_of_time => "time-limit",
        None => ran.outcome.stop.name(),
    }
}

fn untangle_report(mended: &UntangledInput) -> UntangleReport {
    UntangleReport { bad_before: mended.bad_before, sweeps: mended.sweeps, moved: mended.moved }
}

fn engine_report(taken: &OpenEngine, outcome: &Outcome) -> EngineReport {
    let adapter = match &*taken.backend {
        Backend::Cpu => None,
        Backend::Gpu(gpu) => Some(gpu.adapter()),
    };
    EngineReport {
        kind: if adapter.is_some() { "gpu" } else { "cpu" },
        adapter: adapter.map(|adapter| adapter.name.clone()),
        driver: adapter.map(|adapter| adapter.driver.clone()),
        reason: taken.reason.clone(),
        fault: outcome
            .device_fault
            .as_ref()
            .map(|fault| FaultReport { sweep: fault.sweep, error: fault.error.to_string() }),
    }
}

/// Returns the format of IN, and the format of OUT if the formats differ.
pub(super) fn formats(input: &Input<'_>) -> String {
    let own = input.file.source.format();
    match input.form {
        None => own.to_string(),
        Some(form) => format!("{own} to {}", form.format),
    }
}

fn mesh_report(input: &Input<'_>, smoother: &Smoother<'_>) -> MeshReport {
    let file = input.file;
    MeshReport {
        format: file.source.format().to_string(),
        output_format: input.form.map(|form| form.format.to_string()),
        vertices: file.source.points().len(),
        triangles: file.mesh().triangles.len(),
        quadrilaterals: file.mesh().quadrilaterals.len(),
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
