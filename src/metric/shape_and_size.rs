//! Metrics that balance shape and size: μ₂ + 2 w μ₅₆ of TMOP.

use crate::metric::corner::{InvariantSlopes, Invariants, Slopes};
use crate::metric::dual::Real;

/// Returns ε / τ + w (τ - 1)² / τ, where τ = area / mean and ε = excess / mean. The terms are μ₂ = |T|² / 2τ - 1 = ε /
/// τ, and 2 w μ₅₆ with μ₅₆ = (τ - 1)² / 2τ.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Invariants<T>, weight: f64) -> T {
    let scale = 1.0 / t.mean;
    let (e, off) = (t.excess * scale, (t.area - t.mean) * scale);
    (e + off * off * weight) / (t.area * scale)
}

/// Returns [`value`] and its derivatives by the invariants.
#[inline(always)]
pub(super) fn slopes<T: Real>(t: &Invariants<T>, weight: f64) -> Slopes<T> {
    let scale = 1.0 / t.mean;
    let (e, tau, off) = (t.excess * scale, t.area * scale, (t.area - t.mean) * scale);
    let inverse = tau.constant(1.0) / tau;
    let square = inverse * inverse;
    Slopes::ByInvariants(InvariantSlopes {
        unit: e.constant(scale),
        value: (e + off * off * weight) * inverse,
        excess: Some(inverse),
        area: Some((off * (tau + 1.0) * weight - e) * square),
        excess_area: Some(square * -1.0),
        area_area: Some((e + weight) * square * inverse * 2.0),
    })
}
