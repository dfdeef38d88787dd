//! The parameters of one sweep over the free vertices.

use crate::metric::{Metric, Smoothing};
use crate::options::Derivatives;

/// The parameters by which one sweep visits every free vertex, equal for both engines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepParams {
    /// The metric that the sweep lowers.
    pub metric: Metric,
    /// Over-relaxation: factor on each Newton step in its first trial.
    pub omega: f64,
    /// Largest number of Newton steps in one visit of a vertex.
    pub newton_steps: u32,
    /// Binary logarithm of the exponent k of EDGE's p-norm.
    pub sharpness: u32,
    /// Inverse mean ratio toward which a penalty in EDGE's p-norm grows steeply. Newton directions then bend away
    /// before the shape guard rejects a step. Infinite for no penalty.
    pub penalty_guard: f64,
    /// Method by which the metric is differentiated.
    pub derivatives: Derivatives,
    /// Largest inverse mean ratio of a triangle after a step, unless the patch already had a larger one. The guard is
    /// the smallest of [`Plan::worst_guard`](super::Plan::worst_guard) and, for metrics without a barrier, of
    /// [`Plan::shape_guard`](super::Plan::shape_guard) and the metric's own guard, minus a reserve for rounding.
    /// Infinite for no guard.
    pub shape_guard: f64,
    /// Upper limit of the factor by which a Newton step is lengthened where nearly flat triangles dominate the
    /// objective of a patch: 8 in multilevel runs, 1 to turn lengthening off.
    pub max_lengthening: f64,
}

impl SweepParams {
    /// Returns the p-norm and the penalty that replace EDGE in this sweep.
    #[inline(always)]
    pub(crate) fn smoothing(&self) -> Smoothing {
        Smoothing { sharpness: self.sharpness, penalty_guard: self.penalty_guard }
    }
}
