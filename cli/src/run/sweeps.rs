//! The sweeps of a run, on the chosen engine or, after a failure, on the CPU.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use gpu_smooth::{
    Backend, Options, Outcome, Phase, Progress, SmoothError, Stop, Stopping, options::Precision,
};
use gpu_smooth_job::EngineRequest;

use crate::error::CliError;
use crate::load::{LoadedMesh, MovableSelection, explain};
use crate::request::SmoothRequest;
use crate::run::checkpoint::CheckpointSaver;
use crate::run::engine::{self, OpenEngine};
use crate::run::input::Input;
use crate::run::observer::PipelineObserver;
use crate::run::prepare::Ready;
use crate::terminal::interrupt;
use crate::terminal::progress::Stage;

/// A finished run with its engine. `times` pairs sweeps with the elapsed seconds after them.
pub(super) struct FinishedRun {
    pub(super) outcome: Outcome,
    pub(super) taken: OpenEngine,
    pub(super) times: Vec<(u32, f64)>,
    /// Whether the time limit ended the run.
    pub(super) out_of_time: bool,
}

/// Timer of a run's sweeps, which also checks the time limit.
struct SweepClock<'a> {
    input: &'a Input<'a>,
    start: Instant,
    times: Vec<(u32, f64)>,
    out_of_time: bool,
}

impl SweepClock<'_> {
    /// Records the time of a sweep. Returns false if the run calls its observer in the middle of a long step, after a sweep that
    /// is recorded already.
    fn record(&mut self, progress: &Progress) -> bool {
        if progress.phase != Phase::Smoothing {
            return true;
        }
        let is_new = self.times.last().is_none_or(|&(sweep, _)| sweep != progress.sweep);
        if is_new {
            self.times.push((progress.sweep, self.start.elapsed().as_secs_f64()));
        }
        is_new
    }

    /// Breaks if the user interrupts the run or the time limit has passed.
    fn goes_on(&mut self) -> ControlFlow<()> {
        let limit = self.input.request().time_limit;
        self.out_of_time = limit.is_some_and(|limit| self.input.began.elapsed() >= limit);
        match interrupt::is_requested() || self.out_of_time {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    /// Removes records from the outcome's last sweep on, and adds that sweep with the time at the end of the run.
    fn end(&mut self, outcome: &Outcome) {
        self.times.retain(|time| time.0 < outcome.sweeps);
        self.times.push((outcome.sweeps, self.start.elapsed().as_secs_f64()));
    }
}

/// Smooths a mesh. The CPU takes over if the GPU fails, or if the GPU cannot hold the mesh and the command line left
/// the engine open.
pub(super) fn smooth(
    input: &Input<'_>,
    ready: &Ready<'_>,
    follow: &mut dyn PipelineObserver,
) -> Result<FinishedRun, CliError> {
    let request = input.request();
    let options = options(request, input.choice, input.precision());
    follow.stage(Stage::Smoothing);
    let mut clock =
        SweepClock { input, start: Instant::now(), times: Vec::new(), out_of_time: false };
    let follow = Mutex::new(follow);
    let mut kept = CheckpointSaver::new(request.outputs.checkpoint.as_ref(), &follow);
    let mut run = |backend: &Backend| {
        let mut observe = |progress: &Progress| {
            if clock.record(progress) {
                follow.lock().unwrap_or_else(PoisonError::into_inner).sweep(progress);
            }
            clock.goes_on()
        };
        ready
            .smoother
            .run(&options)
            .on(backend)
            .resume(input.task.resumed)
            .checkpoints(&mut kept)
            .observe(&mut observe)
            .block()
    };
    let mut taken = ready.taken.clone();
    let turn = taken.turn();
    let mut outcome = run(&taken.backend);
    drop(turn);
    if let Err(error) = &outcome
        && request.engine == EngineRequest::Auto
        && engine::is_too_large(error)
    {
        taken = OpenEngine::new(Backend::Cpu, Some(error.to_string()));
        outcome = run(&taken.backend);
    }
    let outcome = outcome.map_err(|error| cli_error(request, input.file, error))?;
    clock.end(&outcome);
    let is_canceled = outcome.stop == Stop::Canceled;
    if is_canceled {
        kept.left();
    }
    let out_of_time = clock.out_of_time && is_canceled && !interrupt::is_requested();
    Ok(FinishedRun { outcome, taken, times: clock.times, out_of_time })
}

/// Converts the error of a run to the terms of the file and the command line.
fn cli_error(request: &SmoothRequest, file: &LoadedMesh, error: SmoothError) -> CliError {
    match error {
        SmoothError::Mesh(error) => explain::mesh_error(file, &error),
        SmoothError::Checkpoint(_) => {
            let path = request.continue_from.as_deref().unwrap_or(Path::new(""));
            CliError::from(error).within(&path.display().to_string())
        }
        error if engine::is_too_large(&error) => {
            CliError::from(error).with_remedy("Smooth on the CPU: --engine cpu")
        }
        error => error.into(),
    }
}

/// Returns the options of the run. Without any triangle to improve, the run has no sweeps.
fn options(request: &SmoothRequest, choice: &MovableSelection, stored: Precision) -> Options {
    let options = request.options(stored);
    match choice.nothing_to_do {
        Some(_) => options.max_sweeps(0).stopping(Stopping::default()).improve_worst(None),
        None => options,
    }
}
