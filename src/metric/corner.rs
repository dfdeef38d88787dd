//! A triangle as metrics see it: its edges from one vertex, and its invariants.

use crate::metric::dual::{Dual, Real};

/// A triangle as its metric sees it: the edge vectors from one vertex to the other two, in
/// counter-clockwise order, and what is constant over the mesh.
#[derive(Clone, Copy, Debug)]
pub struct Corner<T> {
    /// Edge vector to the next vertex, counter-clockwise.
    pub a: [T; 2],
    /// Edge vector to the vertex after that.
    pub b: [T; 2],
    /// Mean area of the mesh's triangles, in the square of the edges' unit.
    pub mean_area: f64,
}

/// 1/√3: the target triangle W is equilateral, W⁻¹ = [[1, -1/√3], [0, 2/√3]].
const W: f64 = 0.577_350_269_189_625_8;

impl<T: Real> Corner<T> {
    /// Squared lengths of the edges a, b and b - a.
    #[inline(always)]
    pub(crate) fn squared_lengths(&self) -> [T; 3] {
        let ([ax, ay], [bx, by]) = (self.a, self.b);
        let (cx, cy) = (bx - ax, by - ay);
        [ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy]
    }

    #[inline(always)]
    pub(crate) fn squared_length_sum(&self) -> T {
        let [a, b, c] = self.squared_lengths();
        a + b + c
    }

    /// Twice the signed area.
    #[inline(always)]
    pub fn doubled_area(&self) -> T {
        self.a[0] * self.b[1] - self.a[1] * self.b[0]
    }

    /// The entries T00 - T11 and T01 + T10 of T = A W⁻¹ = [a, (2b - a)/√3]. The sum of their squares is
    /// |T|² - 2 det T, without the cancellation of that difference.
    #[inline(always)]
    fn distortion(&self) -> [T; 2] {
        let ([ax, ay], [bx, by]) = (self.a, self.b);
        [ax - (by * 2.0 - ay) * W, (bx * 2.0 - ax) * W + ay]
    }

    /// What all metrics but EDGE are functions of.
    #[inline(always)]
    pub fn invariants(&self) -> Invariants<T> {
        let [u, v] = self.distortion();
        Invariants {
            excess: (u * u + v * v) * (0.25 / W),
            area: self.doubled_area(),
            mean: 2.0 * self.mean_area,
        }
    }

    /// Value, gradient and Hessian of a function of the invariants with respect to the vertex that the
    /// edges start from, by the chain rule.
    #[inline(always)]
    pub(crate) fn expansion(&self, slopes: &Slopes<T>) -> Dual<T> {
        let [u, v] = self.distortion();
        // Moving the vertex changes u by (-1, w) and v by (-w, -1), w = 1/√3: the Hessian of the excess is
        // 2/√3 times the identity. The area is linear.
        let unit = slopes.unit;
        let (ex, ey) = ((u + v * W) * (-0.5 / W) * unit, (u * W - v) * (0.5 / W) * unit);
        let (dx, dy) = ((self.a[1] - self.b[1]) * unit, (self.b[0] - self.a[0]) * unit);
        // The gradients of ∂f/∂excess and ∂f/∂area.
        let (px, py) = (
            slopes.excess_excess * ex + slopes.excess_area * dx,
            slopes.excess_excess * ey + slopes.excess_area * dy,
        );
        let (rx, ry) = (
            slopes.excess_area * ex + slopes.area_area * dx,
            slopes.excess_area * ey + slopes.area_area * dy,
        );
        let own = slopes.excess * (2.0 * W) * unit;
        Dual {
            value: slopes.value,
            gradient: [
                slopes.excess * ex + slopes.area * dx,
                slopes.excess * ey + slopes.area * dy,
            ],
            hessian: [own + px * ex + rx * dx, px * ey + rx * dy, own + py * ey + ry * dy],
        }
    }
}

impl Corner<f64> {
    /// The inverse mean ratio, 1 for the equilateral triangle; infinite for one without area.
    pub fn inverse_mean_ratio(&self) -> f64 {
        let area = self.doubled_area();
        if area > 0.0 {
            self.squared_length_sum() * (3f64.sqrt() / 6.0) / area
        } else {
            f64::INFINITY
        }
    }
}

/// Numbers of a triangle that no rotation changes. Metrics but EDGE are functions of them: the squared
/// Frobenius norm of T = A W⁻¹, W equilateral of the mean area, is 2 (excess + area) / mean, and its determinant
/// area / mean.
#[derive(Clone, Copy, Debug)]
pub struct Invariants<T> {
    /// √3/6 times the sum of the squared edge lengths, less the doubled area: 0 for an equilateral
    /// triangle and above 0 for every other. Computed as a sum of squares.
    pub excess: T,
    /// Twice the signed area.
    pub area: T,
    /// Twice the mean area of the mesh's triangles.
    pub mean: f64,
}

/// The value of a function of the [`Invariants`] and its partial derivatives, named by what they are taken by. They are
/// by the invariants times `unit`, so that they have no dimension and neither overflow nor vanish in single precision.
#[derive(Clone, Copy, Debug)]
pub struct Slopes<T> {
    /// One over an area, of the triangle or of the mean.
    pub unit: T,
    /// The function itself.
    pub value: T,
    /// The derivative by unit · excess.
    pub excess: T,
    /// The derivative by unit · area.
    pub area: T,
    /// The second derivative by unit · excess.
    pub excess_excess: T,
    /// The mixed second derivative.
    pub excess_area: T,
    /// The second derivative by unit · area.
    pub area_area: T,
}
