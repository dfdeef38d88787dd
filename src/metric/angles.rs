//! Penalties on the large and on the small angles of a triangle, and on the angles of a quadrilateral that are not right, by
//! their cotangents.

use crate::metric::corner::Corner;
use crate::metric::dual::{Dual, Real};
use crate::metric::edge_slopes::{EdgeSlopes, Given};
use crate::metric::hinge::Hinge;

/// Weight of the penalty on large angles.
const LARGE_WEIGHT: f64 = 300.0;
/// The penalty on the cotangents of angles below 37.6 degrees, and its weight.
const SMALL: Hinge = Hinge { limit: 1.3, ramp: 0.2 };
const SMALL_WEIGHT: f64 = 30.0;

/// Factor of the squared cotangent of the angle at a corner of a quadrilateral. With the products of the cotangents of opposite
/// angles (src/metric/opposite_angles.rs), 400 of the factor form squares of sums.
const OF_RIGHT_ANGLE: f64 = 420.0;
/// The penalty on the negative cotangents of angles above 84.3 degrees between a side and a diagonal of a quadrilateral, and its
/// weight.
const AT_DIAGONAL: Hinge = Hinge { limit: -0.1, ramp: 0.1 };
const WEIGHT_AT_DIAGONAL: f64 = 600.0;

/// Returns the penalties on the three angles of a triangle, or on the angle at a corner of a quadrilateral.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Corner<T>) -> T {
    if t.ideal.is_right {
        let [own, b, c] = t.before_shear().cotangents();
        let ([own, ..], [b, ..], [c, ..]) =
            (of_right_angle(own), of_angle_at_diagonal(b), of_angle_at_diagonal(c));
        return own + b + c;
    }
    let [a, b, c] = t.cotangents();
    let ([a, ..], [b, ..], [c, ..]) = (penalties(a), penalties(b), penalties(c));
    a + b + c
}

/// Returns value, first and second derivative of the penalties on an angle, by its cotangent.
#[inline(always)]
fn penalties<T: Real>(cotangent: T) -> [T; 3] {
    let large = Hinge::LARGE_ANGLES.at(cotangent * -1.0);
    let small = SMALL.at(cotangent);
    [
        large[0] * LARGE_WEIGHT + small[0] * SMALL_WEIGHT,
        small[1] * SMALL_WEIGHT - large[1] * LARGE_WEIGHT,
        large[2] * LARGE_WEIGHT + small[2] * SMALL_WEIGHT,
    ]
}

/// Returns value, first and second derivative of the penalty on the angle at a corner of a quadrilateral, by its cotangent.
#[inline(always)]
fn of_right_angle<T: Real>(cotangent: T) -> [T; 3] {
    let slope = cotangent * OF_RIGHT_ANGLE;
    [cotangent * slope, slope * 2.0, cotangent.constant(2.0 * OF_RIGHT_ANGLE)]
}

/// Returns value, first and second derivative of the penalty on an angle between a side and a diagonal of a quadrilateral, by
/// its cotangent.
#[inline(always)]
fn of_angle_at_diagonal<T: Real>(cotangent: T) -> [T; 3] {
    let [value, first, second] = AT_DIAGONAL.at(cotangent * -1.0);
    [value * WEIGHT_AT_DIAGONAL, first * -WEIGHT_AT_DIAGONAL, second * WEIGHT_AT_DIAGONAL]
}

/// Returns value, gradient and Hessian of [`value`] with respect to the visited vertex. `edges` has the slopes of the
/// edges by the position of the vertex.
#[inline(always)]
pub(super) fn expansion<T: Real, E: EdgeSlopes>(t: &Corner<T>, edges: E) -> Dual<T> {
    if !E::IS_OWN && t.ideal.is_right {
        let (t, edges) = (t.before_shear(), Given::before_shear(edges));
        let [own, b, c] = angles_of(&t, edges);
        let (b, c) = (b.expansion(of_angle_at_diagonal), c.expansion(of_angle_at_diagonal));
        return own.expansion(of_right_angle) + b + c;
    }
    let [a, b, c] = angles_of(t, edges);
    a.expansion(penalties) + b.expansion(penalties) + c.expansion(penalties)
}

/// Returns the cotangent of the angle between the edges a and b of a corner, with its derivatives by the visited vertex.
#[inline(always)]
pub(super) fn cotangent<T: Real>(t: &Corner<T>, edges: impl EdgeSlopes) -> Dual<T> {
    let [own, ..] = angles_of(t, edges);
    own.expansion(|cotangent| [cotangent, cotangent.constant(1.0), cotangent.constant(0.0)])
}

/// Returns the angles at the first, second and third vertex of a triangle. Their cotangents are a·b, -a·c and b·c, divided
/// by the doubled area, with c = b - a.
#[inline(always)]
fn angles_of<T: Real>(t: &Corner<T>, edges: impl EdgeSlopes) -> [Angle<T>; 3] {
    let (a, b) = (t.a, t.b);
    let c = [b[0] - a[0], b[1] - a[1]];
    let (alpha, beta, gamma) = (edges.alpha(), edges.beta(), edges.third());
    let inverse_area = a[0].constant(1.0) / t.doubled_area();
    let area = [b[1] * alpha - a[1] * beta, a[0] * beta - b[0] * alpha];
    [
        Angle { u: a, v: b, slopes: [alpha, beta], sign: 1.0, inverse_area, area },
        Angle { u: a, v: c, slopes: [alpha, gamma], sign: -1.0, inverse_area, area },
        Angle { u: b, v: c, slopes: [beta, gamma], sign: 1.0, inverse_area, area },
    ]
}

/// An angle between two edges u and v, which change by `slopes` times the move of the visited vertex. The cotangent of
/// the angle is `sign` u·v, divided by the doubled area.
struct Angle<T> {
    u: [T; 2],
    v: [T; 2],
    slopes: [f64; 2],
    sign: f64,
    /// 1 over the doubled area.
    inverse_area: T,
    /// The gradient of the doubled area, which is linear.
    area: [T; 2],
}

impl<T: Real> Angle<T> {
    /// Returns a function of the cotangent of the angle, given the function with its first two derivatives.
    #[inline(always)]
    fn expansion(&self, function: impl FnOnce(T) -> [T; 3]) -> Dual<T> {
        let Self { u, v, slopes: [of_u, of_v], sign, inverse_area, area } = *self;
        let (of_u, of_v) = (of_u * sign, of_v * sign);
        let cotangent = (u[0] * v[0] + u[1] * v[1]) * inverse_area * sign;
        let [value, first, second] = function(cotangent);
        // The product u·v has the gradient of_u v + of_v u and the Hessian 2 of_u of_v I.
        let x = (v[0] * of_u + u[0] * of_v - cotangent * area[0]) * inverse_area;
        let y = (v[1] * of_u + u[1] * of_v - cotangent * area[1]) * inverse_area;
        let slope = first * inverse_area;
        let (sx, sy) = (x * second * 0.5 - area[0] * slope, y * second * 0.5 - area[1] * slope);
        let (xx, yy, own) = (x * sx, y * sy, slope * (2.0 * self.slopes[0] * of_v));
        Dual {
            value,
            gradient: [first * x, first * y],
            hessian: [xx + xx + own, x * sy + y * sx, yy + yy + own],
        }
    }
}
