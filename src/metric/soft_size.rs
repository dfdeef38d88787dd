//! The metric SOFT-SIZE, which puts shape first and size second.

use crate::metric::corner::Invariants;
use crate::metric::dual::Real;
use crate::metric::properties::Properties;
use crate::metric::shape_and_size;
use crate::metric::slopes::InvariantSlopes;

pub(super) const PROPERTIES: Properties = Properties {
    name: "soft-size",
    formula: "sqrt(|T|² / 2τ - 1 + (τ - 1)² / 5τ), T = A W⁻¹, τ = det T",
    citation: "Knupp, Dobrev, Kolev & Tomov, The target-matrix optimization paradigm for high-order meshes, SIAM J. Sci. Comp. 41 (2019), metrics 2 and 56: μ₂ + 0.4 μ₅₆",
    purpose: "good shapes of about the sizes that targets ask for, with a barrier against inversion: sizes give way to shapes",
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
    wgsl: include_str!("soft_size.wgsl"),
};

/// Weight of (τ - 1)² / τ in q² = μ₂ + 0.4 μ₅₆.
const WEIGHT: f64 = 0.2;

/// Returns q² = μ₂ + 0.4 μ₅₆.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Invariants<T>) -> T {
    shape_and_size::value(t, WEIGHT)
}

/// Returns q² and its derivatives by the invariants.
#[inline(always)]
pub(super) fn slopes<T: Real>(t: &Invariants<T>) -> InvariantSlopes<T> {
    shape_and_size::slopes(t, WEIGHT)
}
