//! Newton's direction for a Hessian that need not be positive definite.

use crate::metric::{Dual, Real};
use crate::patch::numbers::Numbers;

/// A search direction with the slope of the objective along it. In lanes, each vertex has its own direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Direction<T: Numbers> {
    /// Displacement of the vertex in a step of length 1.
    pub(crate) vector: [T; 2],
    /// Derivative of the objective along `vector`; negative for a descent.
    pub(crate) slope: T,
    /// Whether the search may begin. False where the objective is flat or not finite.
    pub(crate) descends: T::Mask,
}

/// Returns the Newton direction d = -H⁻¹g with the slope g·d. The Hessian is made positive definite: its eigenvalues
/// are replaced by their absolute values, and raised to at least `floor` times the larger.
#[inline(always)]
pub(crate) fn newton_direction<T: Numbers>(at: &Dual<T>, floor: f64) -> Direction<T> {
    let [xx, xy, yy] = at.hessian;
    let scale = Real::max(Real::max(xx.abs(), xy.abs()), yy.abs());
    let one = scale.constant(1.0);
    let usual = scale.constant(0.0).lt(scale) & scale.lt(scale.constant(f64::INFINITY));
    let unit = one / scale;
    let (gx, gy) = (at.gradient[0] * unit, at.gradient[1] * unit);
    let [xx, xy, yy] = [xx * unit, xy * unit, yy * unit];
    let (mean, half) = ((xx + yy) * 0.5, (xx - yy) * 0.5);
    let radius = Real::sqrt(half * half + xy * xy);
    let (high, low) = ((mean + radius).abs(), (mean - radius).abs());
    let least = Real::max(high, low) * floor;
    let (high, low) = (one / Real::max(high, least), one / Real::max(low, least));
    // H = mean + R with R² = radius², so the projector on the upper eigenvector is (1 + R/radius)/2.
    let split = radius.constant(0.0).lt(radius);
    let inverse = T::select(split, one / radius, radius);
    let ux = T::select(split, (gx + (half * gx + xy * gy) * inverse) * 0.5, gx);
    let uy = T::select(split, (gy + (xy * gx - half * gy) * inverse) * 0.5, gy);
    let dx = (ux * high + (gx - ux) * low).negative();
    let dy = (uy * high + (gy - uy) * low).negative();
    let slope = (dx * gx + dy * gy) * scale;
    Direction { vector: [dx, dy], slope, descends: usual & slope.lt(slope.constant(0.0)) }
}
