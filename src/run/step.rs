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
    /// A penalty that grows steeply toward this inverse mean ratio is added to EDGE's p-norm, so that Newton directions bend
    /// away before the shape guard rejects a step. Infinite for no penalty.
    pub penalized: f64,
    /// How the metric is differentiated.
    pub derivatives: Derivatives,
    /// The largest inverse mean ratio that a step may leave, unless the patch already had a larger one. It is the
    /// smallest of [`Plan::worst_guard`](super::Plan::worst_guard) and, for metrics without a barrier, of
    /// [`Plan::shape_guard`](super::Plan::shape_guard) and the metric's own guard, minus a reserve for rounding.
    /// Infinite for no guard.
    pub shape_guard: f64,
    /// Upper limit of the factor by which a Newton step is lengthened where nearly flat triangles dominate the objective of a
    /// patch: 8 in multilevel runs, 1 to turn lengthening off.
    pub longest: f64,
}

impl Step {
    /// How EDGE is made smooth in this sweep.
    #[inline(always)]
    pub(crate) fn smoothing(&self) -> Smoothing {
        Smoothing { sharpness: self.sharpness, penalized: self.penalized }
    }
}
