//! The metric TMOP-94 of shape and size. Size has less weight than in TMOP-80 and more than in SOFT-SIZE.

use crate::metric::corner::Invariants;
use crate::metric::dual::Real;
use crate::metric::properties::Properties;
use crate::metric::shape_and_size;
use crate::metric::slopes::InvariantSlopes;

pub(super) const PROPERTIES: Properties = Properties {
    name: "tmop-94",
    formula: "sqrt(|T|² / 2τ - 1 + 3 (τ - 1)² / 4τ), T = A W⁻¹, τ = det T",
    citation: "Knupp, Dobrev, Kolev & Tomov, The target-matrix optimization paradigm for high-order meshes, SIAM J. Sci. Comp. 41 (2019), metric 94: μ₂ + 1.5 μ₅₆",
    purpose: "good shapes of the sizes that targets ask for, with a barrier against inversion: sizes weigh less than in tmop-80",
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
    wgsl: include_str!("tmop_94.wgsl"),
};

/// Weight of (τ - 1)² / τ in q² = μ₂ + 1.5 μ₅₆.
const WEIGHT: f64 = 0.75;

/// Returns q² = μ₂ + 1.5 μ₅₆.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Invariants<T>) -> T {
    shape_and_size::value(t, WEIGHT)
}

/// Returns q² and its derivatives by the invariants.
#[inline(always)]
pub(super) fn slopes<T: Real>(t: &Invariants<T>) -> InvariantSlopes<T> {
    shape_and_size::slopes(t, WEIGHT)
}
