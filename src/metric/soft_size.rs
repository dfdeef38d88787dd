//! The metric SOFT-SIZE, of shape first and size second.

use crate::metric::corner::{InvariantSlopes, Invariants, Slopes};
use crate::metric::dual::Real;
use crate::metric::properties::Properties;

pub(super) const PROPERTIES: Properties = Properties {
    name: "soft-size",
    formula: "|T|² / 2τ - 1 + (τ - 1)² / 5τ = q², T = A W⁻¹, τ = det T",
    citation: "Knupp, Dobrev, Kolev & Tomov, The target-matrix optimization paradigm for high-order meshes, SIAM J. Sci. Comp. 41 (2019), metrics 2 and 56: μ₂ + 0.4 μ₅₆",
    purpose: "good shapes of about the sizes that targets ask for, with a barrier against inversion: sizes give way to shapes",
    barrier: true,
    ideal: 0.0,
    scale_invariant: false,
    is_inverse_mean_ratio: false,
    quadratic: false,
    eigenvalue_floor: 1e-3,
    shape_guard: f64::INFINITY,
    omega: 1.9,
    is_corrected: true,
    wgsl: include_str!("soft_size.wgsl"),
};

/// q² = μ₂ + 0.4 μ₅₆ with μ₂ = |T|² / 2τ - 1 = ε / τ and μ₅₆ = (τ - 1)² / 2τ, where τ = area / mean and
/// ε = excess / mean.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Invariants<T>) -> T {
    let scale = 1.0 / t.mean;
    let (e, tau, off) = (t.excess * scale, t.area * scale, (t.area - t.mean) * scale);
    let inverse = tau.constant(1.0) / tau;
    (e + off * off * 0.2) * inverse
}

/// Value and derivatives of [`value`] by the invariants.
#[inline(always)]
pub(super) fn slopes<T: Real>(t: &Invariants<T>) -> Slopes<T> {
    let scale = 1.0 / t.mean;
    let (e, tau, off) = (t.excess * scale, t.area * scale, (t.area - t.mean) * scale);
    let inverse = tau.constant(1.0) / tau;
    let square = inverse * inverse;
    Slopes::ByInvariants(InvariantSlopes {
        unit: e.constant(scale),
        value: (e + off * off * 0.2) * inverse,
        excess: Some(inverse),
        area: Some((off * (tau + 1.0) * 0.2 - e) * square),
        excess_area: Some(square * -1.0),
        area_area: Some((e * 2.0 + 0.4) * square * inverse),
    })
}
