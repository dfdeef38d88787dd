//! The criterion that ends a run before its largest number of sweeps.

/// The criterion that ends a run before [`Options::max_sweeps`](crate::Options::max_sweeps) sweeps.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Stopping {
    /// The run ends when the estimated distance of f to its limit, relative to f, is below this tolerance, which is 0
    /// or above. The estimate extrapolates the decay of f over the last 16 or more sweeps, or over the last two if each
    /// sweep is corrected from coarser levels. The tolerance therefore bounds the remaining gain, not the change in one
    /// sweep. By EDGE, the estimate describes a p-norm: even with the largest exponent, f ends some 2e-5 above its own
    /// minimum, however small the tolerance. A tolerance of 0 turns the criterion off.
    Tolerance(f64),
    /// The run ends at a share of the way to a desired objective.
    Goal(Goal),
}

impl Stopping {
    /// Returns the tolerance of a run, 0 for a run with a goal.
    pub fn tolerance(self) -> f64 {
        match self {
            Self::Tolerance(tolerance) => tolerance,
            Self::Goal(_) => 0.0,
        }
    }

    /// Returns the goal of a run, `None` for a run with a tolerance.
    pub fn goal(self) -> Option<Goal> {
        match self {
            Self::Tolerance(_) => None,
            Self::Goal(goal) => Some(goal),
        }
    }
}

impl Default for Stopping {
    /// Returns a tolerance of 1e-6.
    fn default() -> Self {
        Self::Tolerance(1e-6)
    }
}

/// The convergence test of Park & Shontz (ICCS 2011), equation (2). The run ends when f_initial - f > fraction ·
/// (f_initial - f_desired), with f the objective by the base metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Share of the way from f_initial to f_desired, above 0 and at most 1. The paper uses 0.95.
    pub fraction: f64,
    /// The objective f_desired by the base metric, a finite number.
    ///
    /// `None` determines the converged optimum of the base metric by search runs before the smoothing. If the base
    /// metric is IMR or AR, a single run searches. For other metrics, the optimum is the better of two runs: by the
    /// base metric alone, and by the base metric after IMR. Search runs are corrected from coarser levels if the metric
    /// supports corrections, and over-relaxed otherwise.
    pub desired: Option<f64>,
}
