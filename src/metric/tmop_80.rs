//! The metric TMOP-80, which weighs shape and size equally.

use crate::metric::corner::Invariants;
use crate::metric::dual::Real;
use crate::metric::properties::Properties;
use crate::metric::slopes::InvariantSlopes;

pub(super) const PROPERTIES: Properties = Properties {
    name: "tmop-80",
    formula: "sqrt((|T|² / 2τ - 1) / 2 + (τ - 1/τ)² / 4), T = A W⁻¹, τ = det T",
    citation: "Knupp, Dobrev, Kolev & Tomov, The target-matrix optimization paradigm for high-order meshes, SIAM J. Sci. Comp. 41 (2019), metric 80 with γ = 1/2",
    purpose: "good shapes of the sizes that targets ask for, in equal parts, with a barrier against inversion: sizes weigh heavily",
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
    wgsl: include_str!("tmop_80.wgsl"),
};

/// Returns q² = (1 - γ) μ₂ + v γ μ₇₇ with γ = 1/2, μ₂ = |T|² / 2τ - 1 = ε / τ and μ₇₇ = (τ - 1/τ)² / 2, where τ = area /
/// mean, ε = excess / mean and v is the size weight. The difference τ - 1/τ is computed as (τ - 1) (τ + 1) / τ.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Invariants<T>) -> T {
    let scale = 1.0 / t.mean;
    let (e, tau, off) = (t.excess * scale, t.area * scale, (t.area - t.mean) * scale);
    let inverse = tau.constant(1.0) / tau;
    let size = off * (tau + 1.0) * inverse;
    e * inverse * 0.5 + size * size * (0.25 * t.size_weight)
}

/// Returns [`value`] and its derivatives by the invariants.
#[inline(always)]
pub(super) fn slopes<T: Real>(t: &Invariants<T>) -> InvariantSlopes<T> {
    let (scale, weight) = (1.0 / t.mean, t.size_weight);
    let (e, tau, off) = (t.excess * scale, t.area * scale, (t.area - t.mean) * scale);
    let inverse = tau.constant(1.0) / tau;
    let square = inverse * inverse;
    let size = off * (tau + 1.0) * inverse;
    InvariantSlopes {
        unit: e.constant(scale),
        value: e * inverse * 0.5 + size * size * (0.25 * weight),
        excess: Some(inverse * 0.5),
        area: Some((size * (square + 1.0) * weight - e * square) * 0.5),
        excess_area: Some(square * -0.5),
        area_area: Some(e * square * inverse + (square * square * 3.0 + 1.0) * (0.5 * weight)),
    }
}
