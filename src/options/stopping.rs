//! The test by which a run ends before its largest number of sweeps.

/// The test by which a run ends before [`Options::max_sweeps`](crate::Options::max_sweeps) sweeps.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Stopping {
    /// The run ends when the estimated distance of f to its limit, relative to f, is below this tolerance: 0 or above.
    /// The estimate extrapolates the decay of f over the last 16 or more sweeps (over the last two where each sweep is
    /// corrected from coarser levels), so the tolerance bounds what remains, not the change in one sweep. By EDGE, the
    /// estimate is that of a p-norm: with the largest exponent f ends some 2e-5 above a minimum of its own, however small
    /// the tolerance. 0 turns the test off.
    Tolerance(f64),
    /// The run ends at a share of the way to a desired objective.
    Goal(Goal),
}

impl Stopping {
    /// The tolerance of a run; 0 for a run with a goal.
    pub fn tolerance(self) -> f64 {
        match self {
            Self::Tolerance(tolerance) => tolerance,
            Self::Goal(_) => 0.0,
        }
    }

    /// The goal of a run; `None` for a run with a tolerance.
    pub fn goal(self) -> Option<Goal> {
        match self {
            Self::Tolerance(_) => None,
            Self::Goal(goal) => Some(goal),
        }
    }
}

impl Default for Stopping {
    /// A tolerance of 1e-6.
    fn default() -> Self {
        Self::Tolerance(1e-6)
    }
}

/// The convergence test of Park & Shontz (ICCS 2011), equation (2): the run ends when
/// f_initial - f > fraction · (f_initial - f_desired), with f the objective by the base metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// The share of the way from f_initial to f_desired, above 0 and at most 1. The paper's is 0.95.
    pub fraction: f64,
    /// The objective f_desired by the base metric, a finite number.
    ///
    /// `None` searches for the converged optimum of the base metric by runs before the smoothing. If the base metric is
    /// IMR or AR, the search is one run. For other metrics the optimum is the better of two runs: one by the base metric
    /// alone, and one by the base metric after IMR. These runs are over-relaxed, or corrected from coarser levels if the
    /// metric supports corrections.
    pub desired: Option<f64>,
}
