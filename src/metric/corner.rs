//! The arguments of metrics: the edges of a triangle from one vertex, and the invariants of the triangle.

use crate::metric::dual::{Dual, Real};
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

    /// Returns value, gradient and Hessian of a function of the invariants with respect to the visited vertex, by the
    /// chain rule. `edges` has the slopes of the edges by the position of the vertex.
    #[inline(always)]
    pub(crate) fn expansion(&self, edges: impl EdgeSlopes, slopes: &Slopes<T>) -> Dual<T> {
        match slopes {
            Slopes::ByShape { inverse_area, shape, value, first, second } => {
                self.expansion_by_shape(edges, *inverse_area, *shape, *value, *first, *second)
            }
            Slopes::ByInvariants(slopes) => self.expansion_by_invariants(edges, slopes),
        }
    }

    /// Returns the gradients of excess and area by the visited vertex. The distortion (u, v) has the gradients (α, -γ)
    /// and (γ, α), with γ = w (2β - α) and w = 1/√3. The area is a linear function of the position of the vertex.
    #[inline(always)]
    fn gradients(&self, edges: impl EdgeSlopes) -> ([T; 2], [T; 2]) {
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
    fn curvature(edges: impl EdgeSlopes) -> f64 {
        let (alpha, beta) = (edges.alpha(), edges.beta());
        2.0 * W * (alpha * alpha - alpha * beta + beta * beta)
    }

    /// Computes [`Self::expansion`] for a function of the shape m = excess / area, given its first two derivatives.
    #[inline(always)]
    fn expansion_by_shape(
        &self,
        edges: impl EdgeSlopes,
        inverse_area: T,
        shape: T,
        value: T,
        first: T,
        second: T,
    ) -> Dual<T> {
        let ([ex, ey], [dx, dy]) = self.gradients(edges);
        // ∇m = (∇excess - m ∇area) / area, and the Hessian of m is (c I - ∇m ∇areaᵀ - ∇area ∇mᵀ) / area, with c the
        // curvature of the excess. The Hessian of f(m) is f' times the Hessian of m, plus f'' ∇m ∇mᵀ. Both terms add up
        // to ∇m sᵀ + s ∇mᵀ + c f' I / area with s = f'' ∇m / 2 - f' ∇area / area.
        let (mx, my) = ((ex - shape * dx) * inverse_area, (ey - shape * dy) * inverse_area);
        let (slope, half) = (first * inverse_area, second * 0.5);
        let (sx, sy) = (half * mx - slope * dx, half * my - slope * dy);
        let (xx, yy, own) = (mx * sx, my * sy, slope * Self::curvature(edges));
        Dual {
            value,
            gradient: [first * mx, first * my],
            hessian: [xx + xx + own, mx * sy + my * sx, yy + yy + own],
        }
    }

    /// Computes [`Self::expansion`] for a function of excess and area that is linear in the excess.
    #[inline(always)]
    fn expansion_by_invariants(
        &self,
        edges: impl EdgeSlopes,
        slopes: &InvariantSlopes<T>,
    ) -> Dual<T> {
        let InvariantSlopes { unit, value, excess, area, excess_area, area_area } = *slopes;
        let ([ex, ey], [dx, dy]) = self.gradients(edges);
        let (ex, ey, dx, dy) = (ex * unit, ey * unit, dx * unit, dy * unit);
        // (px, py) is the gradient of ∂f/∂excess, (rx, ry) the gradient of ∂f/∂area.
        let (px, py) = (times(excess_area, dx), times(excess_area, dy));
        let rx = sum(times(excess_area, ex), times(area_area, dx));
        let ry = sum(times(excess_area, ey), times(area_area, dy));
        let own = times(times(excess, unit), unit.constant(Self::curvature(edges)));
        let zero = unit.constant(0.0);
        Dual {
            value,
            gradient: [
                or(sum(times(excess, ex), times(area, dx)), zero),
                or(sum(times(excess, ey), times(area, dy)), zero),
            ],
            hessian: [
                or(sum(own, sum(times(px, ex), times(rx, dx))), zero),
                or(sum(times(px, ey), times(rx, dy)), zero),
                or(sum(own, sum(times(py, ey), times(ry, dy))), zero),
            ],
        }
    }
}

// Sums and products of derivatives. `None` is a derivative that is zero for every triangle and costs nothing. The
// functions are no closures, as closures would not be compiled with the instructions of the lanes.

#[inline(always)]
#[allow(clippy::manual_map)]
pub(super) fn times<T: Real>(slope: Option<T>, by: T) -> Option<T> {
    match slope {
        Some(slope) => Some(slope * by),
        None => None,
    }
}

#[inline(always)]
fn sum<T: Real>(a: Option<T>, b: Option<T>) -> Option<T> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a + b),
        (Some(one), None) | (None, Some(one)) => Some(one),
        (None, None) => None,
    }
}

#[inline(always)]
pub(super) fn or<T: Real>(slope: Option<T>, zero: T) -> T {
    match slope {
        Some(slope) => slope,
        None => zero,
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

/// Value and derivatives of a function of the [`Invariants`]. A metric chooses the form. The more special the form, the
/// cheaper the metric's sweeps.
#[derive(Clone, Copy, Debug)]
pub enum Slopes<T> {
    /// A function of the shape m = excess / area alone.
    ByShape {
        /// The inverse of the area.
        inverse_area: T,
        /// The shape m.
        shape: T,
        /// The value of the function.
        value: T,
        /// The derivative with respect to m.
        first: T,
        /// The second derivative with respect to m.
        second: T,
    },
    /// A function of excess and area that is linear in the excess.
    ByInvariants(InvariantSlopes<T>),
}

/// Value and partial derivatives of a function of excess and area that is linear in the excess. Each derivative is
/// named after its variables, the invariants times `unit`, and so has no dimension. `None` is a derivative that is zero
/// for every triangle.
#[derive(Clone, Copy, Debug)]
pub struct InvariantSlopes<T> {
    /// Inverse of an area, either the doubled area of the triangle or the doubled mean area.
    pub unit: T,
    /// Value of the function.
    pub value: T,
    /// Derivative by unit · excess.
    pub excess: Option<T>,
    /// Derivative by unit · area.
    pub area: Option<T>,
    /// Mixed second derivative.
    pub excess_area: Option<T>,
    /// Second derivative by unit · area.
    pub area_area: Option<T>,
}
