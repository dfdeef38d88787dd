//! Metrics that balance shape and size: μ₂ + 2 v w μ₅₆ of TMOP, with v the size weight of the mesh's ideal.

use crate::metric::corner::Invariants;
use crate::metric::dual::Real;
use crate::metric::slopes::InvariantSlopes;

/// Returns ε / τ + v w (τ - 1)² / τ, where τ = area / mean, ε = excess / mean, w is `weight` and v the size weight. The
/// terms are μ₂ = |T|² / 2τ - 1 = ε / τ, and 2 v w μ₅₆ with μ₅₆ = (τ - 1)² / 2τ.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Invariants<T>, weight: f64) -> T {
    let (scale, weight) = (1.0 / t.mean, weight * t.size_weight);
    let (e, off) = (t.excess * scale, (t.area - t.mean) * scale);
    (e + off * off * weight) / (t.area * scale)
}

/// Returns [`value`] and its derivatives by the invariants.
#[inline(always)]
pub(super) fn slopes<T: Real>(t: &Invariants<T>, weight: f64) -> InvariantSlopes<T> {
    let (scale, weight) = (1.0 / t.mean, weight * t.size_weight);
    let (e, tau, off) = (t.excess * scale, t.area * scale, (t.area - t.mean) * scale);
    let inverse = tau.constant(1.0) / tau;
    let square = inverse * inverse;
    InvariantSlopes {
        unit: e.constant(scale),
        value: (e + off * off * weight) * inverse,
        excess: Some(inverse),
        area: Some((off * (tau + 1.0) * weight - e) * square),
        excess_area: Some(square * -1.0),
        area_area: Some((e + weight) * square * inverse * 2.0),
    }
}
