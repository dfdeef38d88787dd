//! The metric TMOP-2, the inverse mean ratio less one, which weighs bad shapes less than IMR does.

use crate::metric::corner::Invariants;
use crate::metric::dual::Real;
use crate::metric::properties::Properties;
use crate::metric::slopes::ShapeSlopes;

pub(super) const PROPERTIES: Properties = Properties {
    name: "tmop-2",
    formula: "sqrt(|T|² / 2τ - 1), T = A W⁻¹, τ = det T",
    citation: "Knupp, Dobrev, Kolev & Tomov, The target-matrix optimization paradigm for high-order meshes, SIAM J. Sci. Comp. 41 (2019), metric 2: μ₂",
    purpose: "good shapes whatever their size, as by imr, but f is the mean of imr - 1, as other programs of target-matrix optimization minimize it",
    barrier: true,
    ideal: 0.0,
    least: 0.0,
    scale_invariant: true,
    has_size_weight: false,
    is_inverse_mean_ratio: false,
    quadratic: false,
    eigenvalue_floor: 1e-3,
    shape_guard: f64::INFINITY,
    omega: 1.9,
    is_corrected: true,
    wgsl: include_str!("tmop_2.wgsl"),
};

/// Returns q² = μ₂ = excess / area.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Invariants<T>) -> T {
    t.excess / t.area
}

/// Returns [`value`] and its derivatives by the shape excess / area.
#[inline(always)]
pub(super) fn slopes<T: Real>(t: &Invariants<T>) -> ShapeSlopes<T> {
    let inverse_area = t.area.constant(1.0) / t.area;
    let m = t.excess * inverse_area;
    ShapeSlopes {
        inverse_area,
        shape: m,
        value: m,
        first: m.constant(1.0),
        second: m.constant(0.0),
    }
}
