//! The loop over the sweeps of a run, the same for every engine.

use std::ops::ControlFlow;
use std::time::Duration;

use glam::DVec2;
use web_time::Instant;

use crate::error::GpuError;
use crate::layout::Problem;
use crate::run::corrections::Corrections;
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::keeper::{Keeper, Keeping};
use crate::run::plan::Plan;
use crate::run::saved::Saved;
use crate::run::step::Step;
use crate::run::stop::Stop;
use crate::run::sweeps;

/// A callback that receives the progress of a run and can end it: any `FnMut(&Progress) -> ControlFlow<()>`.
pub trait Observer: FnMut(&Progress) -> ControlFlow<()> {}

impl<F: FnMut(&Progress) -> ControlFlow<()> + ?Sized> Observer for F {}

/// The progress of a run.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// The part of the run in progress.
    pub phase: Phase,
    /// Number of sweeps done. [`Phase::Reference`] takes up to three runs, each counted from 0.
    pub sweep: u32,
    /// The objective by the base metric of the scheme in use.
    pub f: f64,
}

/// A part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The search for the optimum of [`Desired::Auto`](crate::Desired::Auto).
    Reference,
    /// The smoothing of the mesh.
    Smoothing,
    /// The stage after the last sweep in which the worst triangles are improved
    /// ([`Options::improve_worst`](crate::Options::improve_worst)). It consists of passes, not of sweeps.
    Improving,
}

/// Whether the sweeps of a run are corrected.
pub(crate) enum Strategy<'a> {
    /// Sweeps alone.
    Sweeps,
    /// Sweeps corrected from coarser levels.
    Corrected(Box<Corrections<'a>>),
}

impl<'a> Strategy<'a> {
    pub(crate) fn new(problem: &'a Problem, plan: &'a Plan, corrected: bool) -> Self {
        match corrected {
            true => Strategy::Corrected(Box::new(Corrections::new(problem, plan))),
            false => Strategy::Sweeps,
        }
    }

    /// Lists all distinct steps that a run by `plan` can take.
    pub(crate) fn steps(plan: &Plan, corrected: bool) -> Vec<Step> {
        if corrected { Corrections::steps(plan) } else { plan.steps() }
    }

    /// Does up to `sweeps` further sweeps, or fewer if the run ends.
    async fn advance(
        &mut self,
        engine: &mut impl Engine,
        plan: &Plan,
        history: &mut History,
        sweeps: u32,
    ) -> Result<(), GpuError> {
        match self {
            Strategy::Sweeps => sweeps::advance(engine, plan, history, sweeps).await,
            Strategy::Corrected(corrections) => corrections.advance(engine, history, sweeps).await,
        }
    }

    /// Returns the state of the corrections, for a saved state of the run.
    fn saved(&self) -> Option<Vec<u64>> {
        match self {
            Strategy::Sweeps => None,
            Strategy::Corrected(corrections) => Some(corrections.save()),
        }
    }

    /// Restores a saved state, and returns its history.
    fn restored(
        &mut self,
        engine: &mut impl Engine,
        plan: &Plan,
        saved: Saved,
    ) -> Result<History, DriveError> {
        let Saved { log, remaining, corrections, engine: state } = saved;
        let history = History::resumed(plan, &log, remaining);
        let fits = match (self, corrections) {
            (Strategy::Sweeps, None) => true,
            (Strategy::Corrected(strategy), Some(words)) => {
                strategy.restore(&words, log.len(), !state.roots.is_empty())
            }
            _ => false,
        };
        let is_finite = !log.is_empty() && history.first_not_finite(0).is_none();
        match fits && is_finite && engine.restore(&state)? {
            true => Ok(history),
            false => Err(DriveError::Foreign),
        }
    }
}

/// The result of [`drive`].
pub(crate) struct End {
    pub(crate) history: History,
    pub(crate) positions: Vec<DVec2>,
    /// Number of sweeps in which the metrics of the scheme took turns.
    pub(crate) alternated: u32,
    pub(crate) corrections: u32,
    pub(crate) levels_left_out: bool,
    pub(crate) stop: Stop,
}

/// The work for an engine, and the state to start from.
pub(crate) struct Course<'a> {
    pub(crate) plan: &'a Plan,
    /// Whether a lack of room for the coarser levels is an error.
    pub(crate) must: bool,
    pub(crate) phase: Phase,
    /// Number of sweeps before this run, to be added in reports to the observer.
    pub(crate) done: u32,
    /// The saved state that the run continues from, if it does not begin at its start.
    pub(crate) from: Option<Saved>,
}

/// Sweeps on an engine until the run ends.
pub(crate) async fn drive<K: Keeper + ?Sized>(
    mut engine: impl Engine,
    course: Course<'_>,
    mut strategy: Strategy<'_>,
    keeping: &mut Keeping<'_, K>,
    observe: &mut (impl Observer + ?Sized),
) -> Result<End, DriveError> {
    let Course { plan, must, phase, done, from } = course;
    let mut history = match from {
        Some(saved) => strategy.restored(&mut engine, plan, saved)?,
        None => History::new(plan),
    };
    // Begins with one sweep, as its duration is not known yet, and drivers stop submissions that take seconds.
    let mut batch = 1;
    let stop = loop {
        let (start, known) = (Instant::now(), history.f().len());
        strategy.advance(&mut engine, plan, &mut history, batch).await?;
        batch = next_batch(batch, start.elapsed());
        if let Some(sweep) = history.first_not_finite(known) {
            return Err(DriveError::NotFinite { sweep: done + sweep });
        }
        if let (true, Strategy::Corrected(corrections)) = (must, &strategy)
            && let Some(error) = corrections.left_out()
        {
            return Err(DriveError::LeftOut(error.clone()));
        }
        if let Some(stop) = history.stop() {
            break stop;
        }
        let sweep = done + history.sweeps();
        let is_ending = observe(&Progress { phase, sweep, f: history.last() }).is_break();
        let corrections = || strategy.saved();
        keeping.after_sweeps(&mut engine, &history, corrections, is_ending).await?;
        if is_ending {
            break Stop::Canceled;
        }
    };
    let positions = engine.best_positions().await?;
    let (corrections, levels_left_out) = match &strategy {
        Strategy::Sweeps => (0, false),
        Strategy::Corrected(corrections) => (corrections.taken(), corrections.is_left_out()),
    };
    let alternated = match &strategy {
        Strategy::Sweeps => None,
        Strategy::Corrected(corrections) => corrections.alternated(),
    };
    let alternated = alternated.unwrap_or(history.sweeps());
    Ok(End { history, positions, alternated, corrections, levels_left_out, stop })
}

/// The reason why a run could not be completed.
pub(crate) enum DriveError {
    /// The device failed.
    Device(GpuError),
    /// The device has no room for the coarser levels, and the run requires them.
    LeftOut(GpuError),
    /// f is infinite or NaN after this sweep.
    NotFinite { sweep: u32 },
    /// The saved state is from another mesh.
    Foreign,
}

impl From<GpuError> for DriveError {
    fn from(error: GpuError) -> Self {
        Self::Device(error)
    }
}

/// Returns the number of sweeps to do next, chosen so that the observer is called about ten times a second. Results do
/// not depend on it.
fn next_batch(batch: u32, took: Duration) -> u32 {
    let fits = 0.1 * f64::from(batch) / took.as_secs_f64().max(1e-6);
    (fits as u32).clamp(1, 4 * batch).min(100)
}
