//! The metric RMS, the root mean square of the edge lengths.

use crate::metric::corner::Invariants;
use crate::metric::dual::Real;
use crate::metric::properties::Properties;
use crate::metric::slopes::InvariantSlopes;

pub(super) const PROPERTIES: Properties = Properties {
    name: "rms",
    formula: "sqrt((L12² + L23² + L13²) / 3) / L0, L0² = 4 S_mean / sqrt(3)",
    citation: "Knupp, Algebraic mesh quality metrics, SIAM J. Sci. Comp. 23 (2001); Park & Shontz, Table 1, divided by L0 so that it is 1 at best",
    purpose: "shortens edges and evens out sizes: each vertex moves to the mean of its neighbors (Laplacian smoothing that cannot invert); flattens triangles where sizes differ, as far as the shape guard lets it",
    barrier: false,
    ideal: 1.0,
    least: 0.0,
    scale_invariant: false,
    has_size_weight: false,
    is_inverse_mean_ratio: false,
    quadratic: true,
    eigenvalue_floor: 1e-3,
    shape_guard: 30.0,
    omega: 1.9,
    is_corrected: true,
    wgsl: include_str!("rms.wgsl"),
};

/// Returns q² - 1, with q² = (excess + area) / mean. The difference area - mean is exact if both are within a factor of
/// two.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Invariants<T>) -> T {
    (t.excess + (t.area - t.mean)) * (1.0 / t.mean)
}

/// Returns [`value`] and its derivatives by the invariants.
#[inline(always)]
pub(super) fn slopes<T: Real>(t: &Invariants<T>) -> InvariantSlopes<T> {
    let one = t.area.constant(1.0);
    InvariantSlopes {
        unit: t.area.constant(1.0 / t.mean),
        value: value(t),
        excess: Some(one),
        area: Some(one),
        excess_area: None,
        area_area: None,
    }
}
