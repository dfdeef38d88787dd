//! The arguments of metrics: the edges of a triangle from one vertex, and the invariants of the triangle.

use crate::metric::dual::Real;
use crate::metric::edge_slopes::{EdgeSlopes, HEIGHT};

/// A triangle seen from one vertex: the edge vectors to the other two vertices, in counter-clockwise order, and the
/// ideal of the mesh. The argument of a [`Metric`](crate::Metric).
#[derive(Clone, Copy, Debug)]
pub struct Corner<T> {
    /// Edge vector to the next vertex, counter-clockwise.
    pub a: [T; 2],
    /// Edge vector to the third vertex.
    pub b: [T; 2],
    /// The ideal triangle, in the unit of `a` and `b`.
    pub ideal: Ideal,
}

/// The ideal triangle of a mesh, an equilateral triangle of the mean area, and the cost of other areas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ideal {
    /// Mean area of the mesh's triangles, after their target maps are applied.
    pub area: f64,
    /// Factor of the term of size in metrics that have one; see
    /// [`Metric::has_size_weight`](crate::Metric::has_size_weight) and
    /// [`Targets::size_weight`](crate::Targets::size_weight).
    pub size_weight: f64,
    /// Whether the corner is of a quadrilateral, whose ideal is a square; see `Corner::of_right_angle`.
    pub is_right: bool,
}

impl Ideal {
    /// Returns the ideal of a mesh with triangles of the given mean area, with a size weight of 1.
    pub const fn of_area(area: f64) -> Self {
        Self { area, size_weight: 1.0, is_right: false }
    }
}

/// 1/√3. The target triangle W is equilateral, with W⁻¹ = [[1, -1/√3], [0, 2/√3]].
const W: f64 = 0.577_350_269_189_625_8;

/// Returns the edges of a corner of a quadrilateral after the shear that turns right isosceles triangles with legs a and b into
/// equilateral ones: a, and a/2 + (√3/2) b. The corner of a square becomes equilateral, so metrics of triangles measure by how
/// much a corner differs from that of a square (Knupp, SIAM J. Sci. Comput. 22, 2000).
#[inline(always)]
pub(crate) fn of_right_angle<T: Real>([a, b]: [[T; 2]; 2]) -> [[T; 2]; 2] {
    [a, [a[0] * 0.5 + b[0] * HEIGHT, a[1] * 0.5 + b[1] * HEIGHT]]
}

impl<T: Real> Corner<T> {
    /// Returns the corner of a quadrilateral in the form of the metrics, given its edges from the vertex; see
    /// [`of_right_angle`].
    #[inline(always)]
    pub(crate) fn of_right_angle(&self) -> Self {
        let [a, b] = of_right_angle([self.a, self.b]);
        Self { a, b, ideal: Ideal { is_right: true, ..self.ideal } }
    }

    /// Returns the corner whose sheared form, [`of_right_angle`], this corner is.
    #[inline(always)]
    pub(crate) fn before_shear(&self) -> Self {
        const INVERSE: f64 = 1.0 / HEIGHT;
        let ([ax, ay], [bx, by]) = (self.a, self.b);
        let b = [(bx - ax * 0.5) * INVERSE, (by - ay * 0.5) * INVERSE];
        Self { b, ..*self }
    }

    /// Returns the squared lengths of the edges a, b and b - a.
    #[inline(always)]
    pub(crate) fn squared_lengths(&self) -> [T; 3] {
        let ([ax, ay], [bx, by]) = (self.a, self.b);
        let (cx, cy) = (bx - ax, by - ay);
        [ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy]
    }

    /// Returns the sum of the squared edge lengths.
    #[inline(always)]
    pub(crate) fn squared_length_sum(&self) -> T {
        let [a, b, c] = self.squared_lengths();
        a + b + c
    }

    /// Returns twice the signed area.
    #[inline(always)]
    pub fn doubled_area(&self) -> T {
        self.a[0] * self.b[1] - self.a[1] * self.b[0]
    }

    /// Returns T00 - T11 and T01 + T10 of T = A W⁻¹ = [a, (2b - a)/√3]. The sum of the two squares is |T|² - 2 det T,
    /// without the cancellation of this difference.
    #[inline(always)]
    fn distortion(&self) -> [T; 2] {
        let ([ax, ay], [bx, by]) = (self.a, self.b);
        [ax - (by * 2.0 - ay) * W, (bx * 2.0 - ax) * W + ay]
    }

    /// Returns the invariants of the triangle. All metrics except EDGE are functions of the invariants.
    #[inline(always)]
    pub fn invariants(&self) -> Invariants<T> {
        let [u, v] = self.distortion();
        Invariants {
            excess: (u * u + v * v) * (0.25 / W),
            area: self.doubled_area(),
            mean: 2.0 * self.ideal.area,
            size_weight: self.ideal.size_weight,
        }
    }

    /// Returns the gradients of excess and area by the visited vertex. The distortion (u, v) has the gradients (α, -γ)
    /// and (γ, α), with γ = w (2β - α) and w = 1/√3. The area is a linear function of the position of the vertex.
    #[inline(always)]
    pub(super) fn gradients(&self, edges: impl EdgeSlopes) -> ([T; 2], [T; 2]) {
        let [u, v] = self.distortion();
        let ([ax, ay], [bx, by]) = (self.a, self.b);
        let (alpha, beta) = (edges.alpha(), edges.beta());
        let gamma = W * (2.0 * beta - alpha);
        (
            [(u * -alpha + v * -gamma) * (-0.5 / W), (u * -gamma + v * alpha) * (0.5 / W)],
            [by * alpha - ay * beta, ax * beta - bx * alpha],
        )
    }

    /// Returns the factor c of the excess's Hessian c I: 2w (α² - αβ + β²), with w = 1/√3.
    #[inline(always)]
    pub(super) fn curvature(edges: impl EdgeSlopes) -> f64 {
        let (alpha, beta) = (edges.alpha(), edges.beta());
        2.0 * W * (alpha * alpha - alpha * beta + beta * beta)
    }
}

impl Corner<f64> {
    /// Returns the inverse mean ratio: 1 for an equilateral triangle, infinite for a flat or inverted one.
    pub fn inverse_mean_ratio(&self) -> f64 {
        let area = self.doubled_area();
        if area > 0.0 {
            self.squared_length_sum() * (3f64.sqrt() / 6.0) / area
        } else {
            f64::INFINITY
        }
    }
}

/// Quantities of a triangle that do not change when the triangle is rotated. All metrics except EDGE are functions of
/// them.
///
/// For T = A W⁻¹, with A the edges of the triangle and W those of the equilateral triangle of mean area, the squared
/// Frobenius norm is 2 (excess + area) / mean, and the determinant area / mean.
#[derive(Clone, Copy, Debug)]
pub struct Invariants<T> {
    /// √3/6 times the sum of the squared edge lengths, minus the doubled area: 0 for an equilateral triangle, positive
    /// for all others. Computed as a sum of squares.
    pub excess: T,
    /// Twice the signed area.
    pub area: T,
    /// Twice the mean area of the mesh's triangles.
    pub mean: f64,
    /// Factor of the terms of size; see [`Ideal::size_weight`].
    pub size_weight: f64,
}
