//! The parameters of one sweep.

use crate::metric::{Metric, Smoothing};
use crate::options::Derivatives;

/// The parameters by which one sweep visits every free vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The metric that the sweep lowers.
    pub metric: Metric,
    /// Over-relaxation: the factor by which each Newton step is multiplied in its first trial.
    pub omega: f64,
    /// The most Newton steps per visit of a vertex.
    pub inner: u32,
    /// The log2 of the exponent k of EDGE's p-norm.
    pub sharpness: u32,
    /// The inverse mean ratio in front of which a penalty is added to EDGE's p-norm, so that steps turn before the shape guard
    /// refuses them; infinite for none.
    pub penalized: f64,
    /// How the metric is differentiated.
    pub derivatives: Derivatives,
    /// The largest inverse mean ratio that a step may leave, unless the patch already had a larger one. It is the
    /// smallest of [`Plan::worst_guard`](super::Plan::worst_guard) and, for metrics without a barrier, of
    /// [`Plan::shape_guard`](super::Plan::shape_guard) and the metric's own guard, minus a reserve for rounding.
    /// Infinite for no guard.
    pub shape_guard: f64,
    /// How many times as long as Newton's a step may be tried where nearly flat triangles make up most of a patch's objective; 1
    /// for never.
    pub longest: f64,
}

impl Step {
    /// How EDGE is made smooth in this sweep.
    #[inline(always)]
    pub(crate) fn smoothing(&self) -> Smoothing {
        Smoothing { sharpness: self.sharpness, penalized: self.penalized }
    }
}
