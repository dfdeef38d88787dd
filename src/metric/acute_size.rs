//! The metric ACUTE-SIZE: acute angles first, then shapes and the sizes of targets.

use crate::metric::corner::Corner;
use crate::metric::dual::{Dual, Real};
use crate::metric::edge_slopes::EdgeSlopes;
use crate::metric::properties::Properties;
use crate::metric::slopes::Slopes;
use crate::metric::{angles, soft_size};

pub(super) const PROPERTIES: Properties = Properties {
    name: "acute-size",
    formula: "sqrt(soft-size² + 300 Σ ψ(0.2 - cot) + 30 Σ ψ(cot - 1.3)), ψ as in acute",
    citation: "Knupp, Dobrev, Kolev & Tomov, SIAM J. Sci. Comp. 41 (2019), metrics 2 and 56, as in soft-size, and gpu-smooth's own penalties on the cotangents of the angles",
    purpose: "acute angles, and about the sizes that targets ask for: the metric acute beside a target of sizes",
    barrier: true,
    ideal: 0.0,
    least: 0.0,
    scale_invariant: false,
    has_size_weight: true,
    is_inverse_mean_ratio: false,
    quadratic: false,
    eigenvalue_floor: 1e-3,
    shape_guard: f64::INFINITY,
    omega: 1.9,
    is_corrected: true,
    wgsl: include_str!("acute_size.wgsl"),
};

/// Returns q².
#[inline(always)]
pub(super) fn excess<T: Real>(t: &Corner<T>) -> T {
    soft_size::value(&t.invariants()) + angles::value(t)
}

/// Returns value, gradient and Hessian of [`excess`] with respect to the visited vertex. `edges` has the slopes of the
/// edges by the position of the vertex.
#[inline(always)]
pub(super) fn expansion<T: Real>(t: &Corner<T>, edges: impl EdgeSlopes) -> Dual<T> {
    soft_size::slopes(&t.invariants()).expansion(t, edges) + angles::expansion(t, edges)
}
