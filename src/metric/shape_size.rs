//! The metric SHAPE-SIZE, which measures shape and size together.

use crate::metric::corner::Invariants;
use crate::metric::dual::Real;
use crate::metric::properties::Properties;
use crate::metric::slopes::InvariantSlopes;

pub(super) const PROPERTIES: Properties = Properties {
    name: "shape-size",
    formula: "|T - T⁻ᵗ|, T = A W⁻¹, W equilateral of area S_mean",
    citation: "Knupp, Dobrev, Kolev & Tomov, The target-matrix optimization paradigm for high-order meshes, SIAM J. Sci. Comp. 41 (2019), metric 7",
    purpose: "good shapes and even sizes at once, with a barrier against inversion: for uniform meshes, not for graded ones",
    barrier: true,
    ideal: 0.0,
    least: 0.0,
    scale_invariant: false,
    has_size_weight: false,
    is_inverse_mean_ratio: false,
    quadratic: false,
    eigenvalue_floor: 1e-3,
    shape_guard: f64::INFINITY,
    omega: 1.9,
    is_corrected: true,
    wgsl: include_str!("shape_size.wgsl"),
};

/// Returns q² = |T|² (1 + 1/τ²) - 4 with τ = det T = area / mean and |T|² = 2 (ε + τ), ε = excess / mean. Computed as 2
/// ε (1 + 1/τ²) + 2 (τ - 1)² / τ, which is equal and does not cancel.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Invariants<T>) -> T {
    let scale = 1.0 / t.mean;
    let (e, tau, off) = (t.excess * scale, t.area * scale, (t.area - t.mean) * scale);
    let inverse = tau.constant(1.0) / tau;
    (e * (inverse * inverse + 1.0) + off * off * inverse) * 2.0
}

/// Returns [`value`] and its derivatives by the invariants.
#[inline(always)]
pub(super) fn slopes<T: Real>(t: &Invariants<T>) -> InvariantSlopes<T> {
    let scale = 1.0 / t.mean;
    let (e, tau, off) = (t.excess * scale, t.area * scale, (t.area - t.mean) * scale);
    let inverse = tau.constant(1.0) / tau;
    let square = inverse * inverse;
    let cube = square * inverse;
    InvariantSlopes {
        unit: e.constant(scale),
        value: (e * (square + 1.0) + off * off * inverse) * 2.0,
        excess: Some((square + 1.0) * 2.0),
        area: Some((off * (tau + 1.0) * square - e * cube * 2.0) * 2.0),
        excess_area: Some(cube * -4.0),
        area_area: Some((e * inverse * 3.0 + 1.0) * cube * 4.0),
    }
}
