//! The loop over the sweeps of a run, wherever it computes.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use glam::DVec2;

use crate::error::{GpuError, SmoothError};
use crate::layout::Problem;
use crate::run::corrections::Corrections;
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::plan::Plan;
use crate::run::step::Step;
use crate::run::stop::Stop;
use crate::run::sweeps;

/// Hears how far a run is, and may end it: any `FnMut(&Progress) -> ControlFlow<()>`.
pub trait Observer: FnMut(&Progress) -> ControlFlow<()> {}

impl<F: FnMut(&Progress) -> ControlFlow<()> + ?Sized> Observer for F {}

/// How far a run is, for a progress display.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// What the sweeps are for.
    pub phase: Phase,
    /// Sweeps done in this phase.
    pub sweep: u32,
    /// The base objective.
    pub f: f64,
}

/// The part of a run that is under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The optimum is sought that [`Desired::Auto`](crate::Desired::Auto) measures by.
    Reference,
    /// The mesh is smoothed.
    Smoothing,
}

/// How a run goes from sweep to sweep.
pub(crate) enum Strategy<'a> {
    /// Sweeps alone.
    Sweeps,
    /// Sweeps corrected from coarser levels.
    Corrected(Corrections<'a>),
}

impl<'a> Strategy<'a> {
    pub(crate) fn new(problem: &'a Problem, plan: &'a Plan, corrected: bool) -> Self {
        match corrected {
            true => Strategy::Corrected(Corrections::new(problem, plan)),
            false => Strategy::Sweeps,
        }
    }

    /// Every different step that a run by `plan` takes.
    pub(crate) fn steps(plan: &Plan, corrected: bool) -> Vec<Step> {
        if corrected { Corrections::steps(plan) } else { plan.steps() }
    }

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

    /// No correction raises the objective: the last state is the best.
    async fn best_positions(&self, engine: &mut impl Engine) -> Result<Vec<DVec2>, GpuError> {
        match self {
            Strategy::Sweeps => engine.best_positions().await,
            Strategy::Corrected(_) => Ok(engine.positions().await?.into_owned()),
        }
    }
}

/// What a run leaves.
pub(crate) struct End {
    pub(crate) history: History,
    pub(crate) positions: Vec<DVec2>,
    pub(crate) corrections: u32,
    pub(crate) levels_left_out: bool,
    pub(crate) stop: Stop,
}

/// Sweeps on an engine to the end. `done` are sweeps that came before, for the observer. Where levels are a `must`, it is
/// an error that the engine does not hold them.
pub(crate) async fn drive(
    mut engine: impl Engine,
    plan: &Plan,
    mut strategy: Strategy<'_>,
    must: bool,
    (phase, done): (Phase, u32),
    observe: &mut (impl Observer + ?Sized),
) -> Result<End, SmoothError> {
    let mut history = History::new(plan);
    // One to begin with: how long a sweep takes nobody knows, and drivers end submissions of seconds.
    let mut batch = 1;
    let stop = loop {
        let start = Instant::now();
        strategy.advance(&mut engine, plan, &mut history, batch).await?;
        batch = next_batch(batch, start.elapsed());
        if let (true, Strategy::Corrected(corrections)) = (must, &strategy)
            && let Some(error) = corrections.left_out()
        {
            return Err(error.clone().into());
        }
        if let Some(stop) = history.stop() {
            break stop;
        }
        let sweep = done + history.sweeps();
        if observe(&Progress { phase, sweep, f: history.last() }).is_break() {
            break Stop::Cancelled;
        }
    };
    let positions = strategy.best_positions(&mut engine).await?;
    let (corrections, levels_left_out) = match &strategy {
        Strategy::Sweeps => (0, false),
        Strategy::Corrected(corrections) => (corrections.taken(), corrections.left_out().is_some()),
    };
    Ok(End { history, positions, corrections, levels_left_out, stop })
}

/// How many sweeps to ask for next, so that the caller hears something about ten times a second.
/// Results do not depend on it.
fn next_batch(batch: u32, took: Duration) -> u32 {
    let fits = 0.1 * f64::from(batch) / took.as_secs_f64().max(1e-6);
    (fits as u32).clamp(1, 4 * batch).min(100)
}
