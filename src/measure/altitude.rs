//! The altitude of a triangle, by which explicit solvers bound their time step.

use glam::DVec2;

/// The least altitude of a counterclockwise triangle, in the unit of its corners; negative if it is inverted.
pub(crate) fn altitude([p, q, r]: [DVec2; 3]) -> f64 {
    let longest =
        (q - p).length_squared().max((r - q).length_squared()).max((p - r).length_squared());
    (q - p).perp_dot(r - p) / longest.sqrt()
}
