//! The values of the objective by the tracked metrics.

use crate::metric::Metric;

/// The objective f = (1/n) Σ q² (Park & Shontz, equation 1) by each evaluated metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Objectives([f64; Metric::ALL.len()]);

impl Objectives {
    /// Returns objectives without a value by any metric.
    pub(crate) fn empty() -> Self {
        Self([f64::NAN; Metric::ALL.len()])
    }

    /// Sets the objective by `metric`.
    pub(crate) fn set(&mut self, metric: Metric, value: f64) {
        self.0[metric as usize] = value;
    }

    /// Returns the objective by each metric, NaN for metrics that were not evaluated.
    pub(crate) fn values(&self) -> [f64; Metric::ALL.len()] {
        self.0
    }

    /// Returns the objective by `metric`. `None` if the objective was not evaluated.
    pub fn of(&self, metric: Metric) -> Option<f64> {
        Some(self.0[metric as usize]).filter(|f| !f.is_nan())
    }
}
