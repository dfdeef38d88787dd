//! What the loop over sweeps asks of an engine.

use glam::DVec2;

use crate::error::GpuError;
use crate::metric::Metric;
use crate::run::Stop;

/// A run in progress: sweeps according to a [`Plan`](crate::run::plan::Plan), judged by its stop rule after
/// each sweep.
pub trait Engine {
    /// Does up to `sweeps` further sweeps and returns the objectives after each. The first call
    /// puts those before the first sweep in front. Fewer come back when the run stopped.
    ///
    /// # Errors
    /// When the device fails; the run is then lost.
    fn advance(&mut self, sweeps: u32) -> Result<Vec<Objectives>, GpuError>;

    /// Why the run has ended, if it has.
    fn stop(&self) -> Option<Stop>;

    /// The normalized positions of the best state seen by the base metric.
    ///
    /// # Errors
    /// When the device fails.
    fn best_positions(&mut self) -> Result<Vec<DVec2>, GpuError>;
}

/// The objective f = (1/n) Σ q² (Park & Shontz, equation 1) of the metrics that were evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Objectives([f64; Metric::ALL.len()]);

impl Objectives {
    /// None evaluated yet.
    pub(crate) fn untracked() -> Self {
        Self([f64::NAN; Metric::ALL.len()])
    }

    pub(crate) fn set(&mut self, metric: Metric, value: f64) {
        self.0[metric as usize] = value;
    }

    /// The objective by `metric`, if it was evaluated.
    pub fn of(&self, metric: Metric) -> Option<f64> {
        Some(self.0[metric as usize]).filter(|f| !f.is_nan())
    }
}
