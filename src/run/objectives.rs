//! The values of the objective by each metric.

use crate::metric::Metric;

/// The objective f = (1/n) Σ q² (Park & Shontz, equation 1) by each of the metrics that were evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Objectives([f64; Metric::ALL.len()]);

impl Objectives {
    /// Makes objectives of which none has been evaluated yet.
    pub(crate) fn untracked() -> Self {
        Self([f64::NAN; Metric::ALL.len()])
    }

    /// Sets the objective by `metric`.
    pub(crate) fn set(&mut self, metric: Metric, value: f64) {
        self.0[metric as usize] = value;
    }

    /// Returns the value by each metric, NaN for those not evaluated.
    pub(crate) fn values(&self) -> [f64; Metric::ALL.len()] {
        self.0
    }

    /// Makes objectives of these values, NaN for those not evaluated.
    pub(crate) fn of_values(values: [f64; Metric::ALL.len()]) -> Self {
        Self(values)
    }

    /// Returns the objective by `metric`, if it was evaluated.
    pub fn of(&self, metric: Metric) -> Option<f64> {
        Some(self.0[metric as usize]).filter(|f| !f.is_nan())
    }
}
