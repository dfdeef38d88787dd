//! Functions of the invariants with their derivatives, in two forms, and their derivatives by the visited vertex.

use crate::metric::corner::Corner;
use crate::metric::dual::{Dual, Real};
use crate::metric::edge_slopes::EdgeSlopes;

/// Value and derivatives of a function of the [`Invariants`](crate::metric::Invariants). A metric chooses the form. The more
/// special the form, the cheaper the metric's sweeps.
///
/// The two forms are types, not variants of an enum. For an enum, the compiler split each vector into bytes and joined the
/// bytes again, in a fifth of the time of a sweep.
pub(crate) trait Slopes<T> {
    /// Returns value, gradient and Hessian with respect to the visited vertex of `corner`, by the chain rule. `edges` has the
    /// slopes of the edges by the position of the vertex.
    fn expansion(&self, corner: &Corner<T>, edges: impl EdgeSlopes) -> Dual<T>;

    /// Returns the derivatives by excess and area.
    fn derivatives(&self) -> Derivatives<T>;
}

/// The first and second derivatives of a function of excess and area.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Derivatives<T> {
    pub(super) excess: T,
    pub(super) area: T,
    pub(super) excess_excess: T,
    pub(super) excess_area: T,
    pub(super) area_area: T,
}

/// A function of the shape m = excess / area alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShapeSlopes<T> {
    /// The inverse of the area.
    pub(super) inverse_area: T,
    /// The shape m.
    pub(super) shape: T,
    /// The value of the function.
    pub(super) value: T,
    /// The derivative with respect to m.
    pub(super) first: T,
    /// The second derivative with respect to m.
    pub(super) second: T,
}

impl<T: Real> Slopes<T> for ShapeSlopes<T> {
    #[inline(always)]
    fn expansion(&self, corner: &Corner<T>, edges: impl EdgeSlopes) -> Dual<T> {
        let Self { inverse_area, shape, value, first, second } = *self;
        let ([ex, ey], [dx, dy]) = corner.gradients(edges);
        // ∇m = (∇excess - m ∇area) / area, and the Hessian of m is (c I - ∇m ∇areaᵀ - ∇area ∇mᵀ) / area, with c the
        // curvature of the excess. The Hessian of f(m) is f' times the Hessian of m, plus f'' ∇m ∇mᵀ. Both terms add up
        // to ∇m sᵀ + s ∇mᵀ + c f' I / area with s = f'' ∇m / 2 - f' ∇area / area.
        let (mx, my) = ((ex - shape * dx) * inverse_area, (ey - shape * dy) * inverse_area);
        let (slope, half) = (first * inverse_area, second * 0.5);
        let (sx, sy) = (half * mx - slope * dx, half * my - slope * dy);
        let (xx, yy, own) = (mx * sx, my * sy, slope * Corner::<T>::curvature(edges));
        Dual {
            value,
            gradient: [first * mx, first * my],
            hessian: [xx + xx + own, mx * sy + my * sx, yy + yy + own],
        }
    }

    #[inline(always)]
    fn derivatives(&self) -> Derivatives<T> {
        let Self { inverse_area: inverse, shape: m, first, second, .. } = *self;
        let square = inverse * inverse;
        Derivatives {
            excess: first * inverse,
            area: first * m * inverse * -1.0,
            excess_excess: second * square,
            excess_area: (second * m + first) * square * -1.0,
            area_area: (second * m + first * 2.0) * m * square,
        }
    }
}

/// Value and partial derivatives of a function of excess and area that is linear in the excess. Each derivative is
/// named after its variables, the invariants times `unit`, and so has no dimension. `None` is a derivative that is zero
/// for every triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InvariantSlopes<T> {
    /// Inverse of an area, either the doubled area of the triangle or the doubled mean area.
    pub(super) unit: T,
    /// Value of the function.
    pub(super) value: T,
    /// Derivative by unit · excess.
    pub(super) excess: Option<T>,
    /// Derivative by unit · area.
    pub(super) area: Option<T>,
    /// Mixed second derivative.
    pub(super) excess_area: Option<T>,
    /// Second derivative by unit · area.
    pub(super) area_area: Option<T>,
}

impl<T: Real> Slopes<T> for InvariantSlopes<T> {
    #[inline(always)]
    fn expansion(&self, corner: &Corner<T>, edges: impl EdgeSlopes) -> Dual<T> {
        let Self { unit, value, excess, area, excess_area, area_area } = *self;
        let ([ex, ey], [dx, dy]) = corner.gradients(edges);
        let (ex, ey, dx, dy) = (ex * unit, ey * unit, dx * unit, dy * unit);
        // (px, py) is the gradient of ∂f/∂excess, (rx, ry) the gradient of ∂f/∂area.
        let (px, py) = (times(excess_area, dx), times(excess_area, dy));
        let rx = sum(times(excess_area, ex), times(area_area, dx));
        let ry = sum(times(excess_area, ey), times(area_area, dy));
        let own = times(times(excess, unit), unit.constant(Corner::<T>::curvature(edges)));
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

    #[inline(always)]
    fn derivatives(&self) -> Derivatives<T> {
        let Self { unit, excess, area, excess_area, area_area, .. } = *self;
        let (zero, square) = (unit.constant(0.0), unit * unit);
        Derivatives {
            excess: or(times(excess, unit), zero),
            area: or(times(area, unit), zero),
            excess_excess: zero,
            excess_area: or(times(excess_area, square), zero),
            area_area: or(times(area_area, square), zero),
        }
    }
}

// Sums and products of derivatives. `None` is a derivative that is zero for every triangle and costs nothing. The
// functions are no closures, as closures would not be compiled with the instructions of the lanes.

#[inline(always)]
#[allow(clippy::manual_map)]
fn times<T: Real>(slope: Option<T>, by: T) -> Option<T> {
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
fn or<T: Real>(slope: Option<T>, zero: T) -> T {
    match slope {
        Some(slope) => slope,
        None => zero,
    }
}
