//! The altitude of a triangle, which bounds the time step of explicit solvers.

use glam::DVec2;

/// Returns the least altitude of a triangle, in the unit of its corners; negative if the corners are clockwise.
pub(crate) fn altitude([p, q, r]: [DVec2; 3]) -> f64 {
    let longest =
        (q - p).length_squared().max((r - q).length_squared()).max((p - r).length_squared());
    (q - p).perp_dot(r - p) / longest.sqrt()
}
