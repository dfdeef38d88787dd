//! The regularization ε = √(least + share min(d, 0)²) of the energy that untangling lowers, where d is the smallest
//! area of a triangle relative to its target area. The host uses the formula itself, and its constants are injected
//! into WGSL. This rule is the robust one among the rules of Garanzha et al., *Foldover-free maps in 50 lines of code*,
//! ACM Transactions on Graphics 40 (2021).

/// `least` in the formula: the square of ε on a mesh without inverted triangles.
pub(crate) const MIN_SQUARE: f64 = 1e-12;
/// `share` in the formula: the factor on the square of the smallest area.
pub(crate) const SQUARE_SHARE: f64 = 0.04;

/// Returns ε for the next sweep, given the smallest area relative to its target area.
pub(crate) fn epsilon(least: f64) -> f64 {
    let least = least.min(0.0);
    (MIN_SQUARE + SQUARE_SHARE * least * least).sqrt()
}
