//! A run in progress: an engine, and the state that determines its next sweeps.

use std::ops::ControlFlow;
use std::time::Duration;

use web_time::Instant;

use crate::error::GpuError;
use crate::layout::Problem;
use crate::run::checkpoint_policy::{Checkpointer, PeriodSource};
use crate::run::corrections::Corrections;
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::objectives::Objectives;
use crate::run::plan::Plan;
use crate::run::saved::Saved;
use crate::run::stop::Stop;
use crate::run::sweep_params::SweepParams;
use crate::run::sweeping::Sweeping;

/// A callback that receives the progress of a run and can end the run: any `FnMut(&Progress) -> ControlFlow<()>` that
/// is `Send`. Browsers have no threads, so `Send` is not required there.
#[cfg(not(target_family = "wasm"))]
pub trait Observer: FnMut(&Progress) -> ControlFlow<()> + Send {}

#[cfg(not(target_family = "wasm"))]
impl<F: FnMut(&Progress) -> ControlFlow<()> + Send + ?Sized> Observer for F {}

/// A callback that receives the progress of a run and can end the run: any `FnMut(&Progress) -> ControlFlow<()>`.
#[cfg(target_family = "wasm")]
pub trait Observer: FnMut(&Progress) -> ControlFlow<()> {}

#[cfg(target_family = "wasm")]
impl<F: FnMut(&Progress) -> ControlFlow<()> + ?Sized> Observer for F {}

/// The progress of a run, as reported to an [`Observer`].
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// The part of the run in progress.
    pub phase: Phase,
    /// Number of completed sweeps. [`Phase::Reference`] takes up to three runs, each counted from 0.
    pub sweep: u32,
    /// Objective by the base metric of the scheme in use.
    pub f: f64,
}

/// A part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Phase {
    /// The search for the optimum, if [`Goal::desired`](crate::Goal::desired) is `None`.
    Reference,
    /// The smoothing of the mesh.
    Smoothing,
    /// The stage after the last sweep that improves the worst triangles
    /// ([`Options::improve_worst`](crate::Options::improve_worst)). The stage counts passes instead of sweeps.
    Improving,
}

/// Whether corrections from coarser levels follow the sweeps of a run.
pub(crate) enum Strategy {
    /// Sweeps without corrections.
    Sweeps(Sweeping),
    /// Sweeps with corrections from coarser levels.
    Corrected(Box<Corrections>),
}

/// Returns all distinct steps that a run by `plan` can take.
pub(crate) fn steps(plan: &Plan, corrected: bool) -> Vec<SweepParams> {
    if corrected { Corrections::steps(plan) } else { plan.steps() }
}

/// A leg of a run: the whole run, or a period between two evaluations of a target field on the host.
#[derive(Clone, Copy)]
pub(crate) struct Leg<'l> {
    /// Last sweep of the leg, counted from the start of the session.
    pub(crate) until: u32,
    /// Whether a device without room for the coarser levels is an error: true for
    /// [`Method::Multilevel`](crate::Method::Multilevel).
    pub(crate) requires_levels: bool,
    /// Phase in reports to the observer.
    pub(crate) phase: Phase,
    /// Number of sweeps on the CPU before the engine began, which reports to the observer include.
    pub(crate) done: u32,
    /// Source of the state of the host and the stage, for checkpoints.
    pub(crate) period: PeriodSource<'l>,
}

/// An engine with the plan, strategy and history of its run.
pub(crate) struct Session<E> {
    pub(crate) engine: E,
    plan: Plan,
    strategy: Strategy,
    history: History,
    /// Size, in sweeps, of the next batch, after which the observer is called. The first batch is a single sweep of
    /// unknown duration, as drivers stop submissions that take seconds.
    batch: u32,
}

impl<E: Engine> Session<E> {
    /// Begins a run by `plan` on an engine at its start, or after the sweeps in `log`.
    pub(crate) fn new(engine: E, plan: &Plan, strategy: Strategy, log: &[Objectives]) -> Self {
        let history = History::resumed(plan, log, None);
        Self { engine, plan: plan.clone(), strategy, history, batch: 1 }
    }

    /// Returns to a saved state. [`DriveError::Foreign`] if the state does not fit the run.
    pub(crate) async fn restore(&mut self, saved: Saved) -> Result<(), DriveError> {
        let Saved { log, remaining, control, engine: state } = saved;
        self.history = History::resumed(&self.plan, &log, remaining);
        let Self { strategy, engine, history, .. } = self;
        let fits = match strategy {
            Strategy::Sweeps(sweeping) => sweeping.restore(&control, engine, history)?,
            Strategy::Corrected(corrections) => {
                corrections.restore(&control, log.len(), !state.roots.is_empty())
            }
        };
        let is_finite = !log.is_empty() && self.history.first_not_finite(0).is_none();
        if let Strategy::Corrected(corrections) = &mut self.strategy {
            corrections.restore_local_maps(&state);
            if let Some(problem) = corrections.in_plane() {
                self.engine.set_maps(problem)?;
            }
        }
        match fits && is_finite && self.engine.restore(&state).await? {
            true => Ok(()),
            false => Err(DriveError::Foreign),
        }
    }

    pub(crate) fn history(&self) -> &History {
        &self.history
    }

    /// Sweeps to the end of a leg. Returns the reason if the run ends, and `None` at the end of the leg.
    pub(crate) async fn advance(
        &mut self,
        leg: Leg<'_>,
        checkpointer: &mut Checkpointer<'_>,
        observe: &mut dyn Observer,
    ) -> Result<Option<Stop>, DriveError> {
        let Leg { until, requires_levels, phase, done, period } = leg;
        loop {
            let left = until - self.history.sweeps().min(until);
            if left == 0 && !self.history.is_empty() {
                return Ok(None);
            }
            let (start, known) = (Instant::now(), self.history.f().len());
            let sweeps = self.batch.min(left);
            self.sweep(sweeps).await?;
            self.batch = next_batch(sweeps.max(1), start.elapsed());
            if let Some(sweep) = self.history.first_not_finite(known) {
                return Err(DriveError::NotFinite { sweep: done + sweep });
            }
            if let (true, Strategy::Corrected(corrections)) = (requires_levels, &self.strategy)
                && let Some(error) = corrections.left_out()
            {
                return Err(DriveError::LeftOut(error.clone()));
            }
            if let Some(stop) = self.history.stop() {
                return Ok(Some(stop));
            }
            let sweep = done + self.history.sweeps();
            let f = self.history.last();
            let is_ending = observe(&Progress { phase, sweep, f }).is_break();
            let Self { engine, strategy, history, .. } = self;
            let control = || match strategy {
                Strategy::Sweeps(sweeping) => sweeping.save(),
                Strategy::Corrected(corrections) => corrections.save(),
            };
            checkpointer.after_sweeps(engine, history, control, period, is_ending).await?;
            if is_ending {
                return Ok(Some(Stop::Canceled));
            }
        }
    }

    /// Does up to `sweeps` further sweeps, fewer if the run ends.
    async fn sweep(&mut self, sweeps: u32) -> Result<(), GpuError> {
        let Self { engine, plan, strategy, history, .. } = self;
        match strategy {
            Strategy::Sweeps(sweeping) => sweeping.advance(engine, plan, history, sweeps).await,
            Strategy::Corrected(corrections) => corrections.advance(engine, history, sweeps).await,
        }
    }

    /// Records that the host has moved vertices after `from` sweeps, or has changed targets. `now` are the objectives
    /// at the new state, from which the run continues. Lower objectives of sweeps after `from` no longer count.
    pub(crate) fn disturbed(&mut self, from: u32, now: Objectives) {
        self.history.replace_after(from, now);
        self.history.end(None, self.history.remaining());
        if let Strategy::Corrected(corrections) = &mut self.strategy {
            corrections.disturbed(self.history.last());
        }
    }

    /// Replaces the targets by those of `problem`. Its layout must equal that of the run's problem.
    pub(crate) fn set_targets(&mut self, problem: &Problem) -> Result<(), GpuError> {
        let problem = match &mut self.strategy {
            Strategy::Sweeps(_) => problem,
            Strategy::Corrected(corrections) => corrections.set_targets(problem),
        };
        self.engine.set_maps(problem)
    }

    /// Returns the counts of sweeps and corrections for the report.
    pub(crate) fn counts(&self) -> Counts {
        let sweeps = self.history.sweeps();
        match &self.strategy {
            Strategy::Sweeps(_) => Counts { alternated: sweeps, ..Counts::NONE },
            Strategy::Corrected(corrections) => Counts {
                alternated: corrections.alternated().unwrap_or(sweeps),
                corrections: corrections.taken(),
                newton_steps: corrections.steps_taken()[0],
                newton_iterations: corrections.steps_taken()[1],
                levels_left_out: corrections.is_left_out(),
                levels: corrections.levels_time(),
            },
        }
    }
}

/// The counts of sweeps and corrections in the report of a run.
#[derive(Clone, Copy)]
pub(crate) struct Counts {
    /// Number of sweeps with alternating metrics. In runs with corrections, metrics alternate only before the first
    /// correction.
    pub(crate) alternated: u32,
    pub(crate) corrections: u32,
    /// Number of Newton steps of all vertices, and of iterations of conjugate gradients in all of them.
    pub(crate) newton_steps: u32,
    pub(crate) newton_iterations: u32,
    pub(crate) levels_left_out: bool,
    /// Time of building and fitting the coarser levels.
    pub(crate) levels: Duration,
}

impl Counts {
    /// The counts of a run without sweeps.
    pub(crate) const NONE: Self = Self {
        alternated: 0,
        corrections: 0,
        newton_steps: 0,
        newton_iterations: 0,
        levels_left_out: false,
        levels: Duration::ZERO,
    };
}

/// The reason why a run cannot continue.
pub(crate) enum DriveError {
    /// The device failed.
    Device(GpuError),
    /// The run requires the coarser levels, but the device has no room for them.
    LeftOut(GpuError),
    /// f is infinite or NaN after the given sweep.
    NotFinite { sweep: u32 },
    /// The saved state does not fit the mesh, the plan or the engine.
    Foreign,
}

impl From<GpuError> for DriveError {
    fn from(error: GpuError) -> Self {
        Self::Device(error)
    }
}

/// Returns the next number of sweeps, such that the observer is called about ten times a second. The number does not
/// affect the result.
fn next_batch(batch: u32, took: Duration) -> u32 {
    let fits = 0.1 * f64::from(batch) / took.as_secs_f64().max(1e-6);
    (fits as u32).clamp(1, 4 * batch).min(100)
}
