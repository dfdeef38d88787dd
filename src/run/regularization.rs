//! The ε of the energy that untangling lowers, the same for both engines and injected into WGSL. It is √(least + share
//! min(d, 0)²), with d the least area of a triangle relative to the area that it should have. This is the robust one of
//! the rules of Garanzha et al., *Foldover-free maps in 50 lines of code*, ACM Transactions on Graphics 40 (2021).

/// `least`: the square of ε if no triangle is inverted.
pub(crate) const LEAST_SQUARE: f64 = 1e-12;
/// `share`: the factor of the square of the least area.
pub(crate) const SQUARE_SHARE: f64 = 0.04;

/// Returns ε for the next sweep, given the least area relative to its target.
pub(crate) fn epsilon(least: f64) -> f64 {
    let least = least.min(0.0);
    (LEAST_SQUARE + SQUARE_SHARE * least * least).sqrt()
}
