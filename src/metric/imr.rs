//! The metric IMR, the inverse mean ratio.

use crate::metric::corner::Invariants;
use crate::metric::dual::Real;
use crate::metric::properties::Properties;
use crate::metric::slopes::ShapeSlopes;

pub(super) const PROPERTIES: Properties = Properties {
    name: "imr",
    formula: "|A W⁻¹|² / (2 det(A W⁻¹)), W equilateral",
    citation: "Munson, Mesh shape-quality optimization using the inverse mean-ratio metric, Math. Program. 110 (2007)",
    purpose: "the all-round choice: well-shaped triangles whatever their size, and a barrier against inversion",
    barrier: true,
    ideal: 1.0,
    least: 1.0,
    scale_invariant: true,
    has_size_weight: false,
    is_inverse_mean_ratio: true,
    quadratic: false,
    eigenvalue_floor: 1e-3,
    shape_guard: f64::INFINITY,
    omega: 1.9,
    is_corrected: true,
    wgsl: include_str!("imr.wgsl"),
};

/// Returns q² - 1 for q = 1 + m, m = excess / area, computed as m (m + 2), which does not cancel on good triangles.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Invariants<T>) -> T {
    let m = t.excess / t.area;
    m * (m + 2.0)
}

/// Returns [`value`] and its derivatives by the shape m = excess / area.
#[inline(always)]
pub(super) fn slopes<T: Real>(t: &Invariants<T>) -> ShapeSlopes<T> {
    let inverse_area = t.area.constant(1.0) / t.area;
    let m = t.excess * inverse_area;
    ShapeSlopes {
        inverse_area,
        shape: m,
        value: m * (m + 2.0),
        first: (m + 1.0) * 2.0,
        second: m.constant(2.0),
    }
}
