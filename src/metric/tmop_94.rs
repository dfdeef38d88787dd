//! The metric TMOP-94, of shape and size, the milder of the balanced ones.

use crate::metric::corner::{InvariantSlopes, Invariants, Slopes};
use crate::metric::dual::Real;
use crate::metric::properties::Properties;

pub(super) const PROPERTIES: Properties = Properties {
    name: "tmop-94",
    formula: "|T|² / 2τ - 1 + 3 (τ - 1)² / 4τ = q², T = A W⁻¹, τ = det T",
    citation: "Knupp, Dobrev, Kolev & Tomov, The target-matrix optimization paradigm for high-order meshes, SIAM J. Sci. Comp. 41 (2019), metric 94: μ₂ + 1.5 μ₅₆",
    purpose: "good shapes of the sizes that targets ask for, with a barrier against inversion: sizes weigh less than in tmop-80",
    barrier: true,
    ideal: 0.0,
    scale_invariant: false,
    is_inverse_mean_ratio: false,
    quadratic: false,
    eigenvalue_floor: 1e-3,
    shape_guard: f64::INFINITY,
    omega: 1.9,
    is_corrected: true,
    wgsl: include_str!("tmop_94.wgsl"),
};

/// q² = μ₂ + 1.5 μ₅₆ with μ₂ = |T|² / 2τ - 1 = ε / τ and μ₅₆ = (τ - 1)² / 2τ, where τ = area / mean and
/// ε = excess / mean.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Invariants<T>) -> T {
    let scale = 1.0 / t.mean;
    let (e, tau, off) = (t.excess * scale, t.area * scale, (t.area - t.mean) * scale);
    let inverse = tau.constant(1.0) / tau;
    (e + off * off * 0.75) * inverse
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
        value: (e + off * off * 0.75) * inverse,
        excess: Some(inverse),
        area: Some((off * (tau + 1.0) * 0.75 - e) * square),
        excess_area: Some(square * -1.0),
        area_area: Some((e * 2.0 + 1.5) * square * inverse),
    })
}
