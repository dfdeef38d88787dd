//! ε of the energy that untangling lowers, the same for both engines and injected into WGSL: √(least + share min(d, 0)²), with
//! the least area d of a triangle in units of the area that it should have. It is the robust one of the rules of Garanzha et
//! al., *Foldover-free maps in 50 lines of code*, ACM Transactions on Graphics 40 (2021).

/// The square of ε where no triangle is inverted.
pub(crate) const LEAST_SQUARE: f64 = 1e-12;
/// The share of the square of the least area.
pub(crate) const SQUARE_SHARE: f64 = 0.04;

/// ε for the next sweep, given the least area in units of its target.
pub(crate) fn epsilon(least: f64) -> f64 {
    let least = least.min(0.0);
    (LEAST_SQUARE + SQUARE_SHARE * least * least).sqrt()
}
