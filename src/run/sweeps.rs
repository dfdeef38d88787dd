//! Runs of sweeps without corrections, by one metric or by several metrics in turn.

use glam::DVec2;

use crate::error::GpuError;
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::objectives::Objectives;
use crate::run::plan::Plan;
use crate::run::stop::Stop;

/// Does up to `sweeps` further sweeps of the plan, fewer if the run ends.
pub(crate) async fn advance(
    engine: &mut impl Engine,
    plan: &Plan,
    history: &mut History,
    sweeps: u32,
) -> Result<(), GpuError> {
    let first = history.sweeps() + 1;
    let steps: Vec<_> =
        (first..first.saturating_add(sweeps)).map(|sweep| plan.step(sweep)).collect();
    engine.sweeps(&steps, history).await
}

/// A run that its caller drives batch by batch, for benchmarks and experiments.
pub(crate) struct StepwiseRun<E> {
    engine: E,
    plan: Plan,
    history: History,
}

impl<E: Engine> StepwiseRun<E> {
    pub(crate) fn new(engine: E, plan: Plan) -> Self {
        let history = History::new(&plan);
        Self { engine, plan, history }
    }
}

/// A run that its caller drives batch by batch, on the CPU or a device. All calls block.
pub trait Stepwise {
    /// Does up to `sweeps` further sweeps, fewer if the run ends, and returns the objectives after each sweep. The
    /// first call prepends the objectives of the initial positions.
    ///
    /// # Errors
    /// A [`GpuError`] if the device fails. The run is then lost.
    fn advance(&mut self, sweeps: u32) -> Result<Vec<Objectives>, GpuError>;

    /// Returns the reason why the run has ended. `None` while the run can continue.
    fn stop(&self) -> Option<Stop>;

    /// Returns the normalized positions of the state with the smallest base objective so far.
    ///
    /// # Errors
    /// A [`GpuError`] if the device fails.
    fn best_positions(&mut self) -> Result<Vec<DVec2>, GpuError>;
}

impl<E: Engine> Stepwise for StepwiseRun<E> {
    fn advance(&mut self, sweeps: u32) -> Result<Vec<Objectives>, GpuError> {
        let before = self.history.log().len();
        let Self { engine, plan, history } = self;
        pollster::block_on(advance(engine, plan, history, sweeps))?;
        Ok(self.history.log()[before..].to_vec())
    }

    fn stop(&self) -> Option<Stop> {
        self.history.stop()
    }

    fn best_positions(&mut self) -> Result<Vec<DVec2>, GpuError> {
        pollster::block_on(self.engine.best_positions())
    }
}
