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

/// Factor of the squared cotangent of the angle at a corner of a quadrilateral.
const OF_RIGHT_ANGLE: f64 = 40.0;

/// Returns the penalties on the three angles of a triangle, or on the angle at a corner of a quadrilateral.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Corner<T>) -> T {
    if t.ideal.is_right {
        let [cotangent, _, _] = t.before_shear().cotangents();
        return cotangent * cotangent * OF_RIGHT_ANGLE;
    }
    let [a, b, c] = t.cotangents();
    let ([a, _, _], [b, _, _], [c, _, _]) = (penalties(a), penalties(b), penalties(c));
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

/// Returns value, gradient and Hessian of [`value`] with respect to the visited vertex. `edges` has the slopes of the
/// edges by the position of the vertex.
#[inline(always)]
pub(super) fn expansion<T: Real, E: EdgeSlopes>(t: &Corner<T>, edges: E) -> Dual<T> {
    if !E::IS_OWN && t.ideal.is_right {
        return of_right_angle(&t.before_shear(), Given::before_shear(edges));
    }
    let (a, b) = (t.a, t.b);
    let c = [b[0] - a[0], b[1] - a[1]];
    let (alpha, beta, gamma) = (edges.alpha(), edges.beta(), edges.third());
    let inverse_area = a[0].constant(1.0) / t.doubled_area();
    let area = [b[1] * alpha - a[1] * beta, a[0] * beta - b[0] * alpha];
    // The cotangents are a·b, -a·c and b·c, divided by the doubled area.
    let one = Angle { u: a, v: b, slopes: [alpha, beta], sign: 1.0 };
    let two = Angle { u: a, v: c, slopes: [alpha, gamma], sign: -1.0 };
    let three = Angle { u: b, v: c, slopes: [beta, gamma], sign: 1.0 };
    let (one, two) = (one.expansion(inverse_area, area), two.expansion(inverse_area, area));
    one + two + three.expansion(inverse_area, area)
}

/// Returns the penalty on the angle at a corner of a quadrilateral, which is not sheared, with its derivatives.
#[inline(always)]
fn of_right_angle<T: Real>(t: &Corner<T>, edges: Given) -> Dual<T> {
    let (a, b, alpha, beta) = (t.a, t.b, edges.alpha(), edges.beta());
    let inverse_area = a[0].constant(1.0) / t.doubled_area();
    let area = [b[1] * alpha - a[1] * beta, a[0] * beta - b[0] * alpha];
    let angle = Angle { u: a, v: b, slopes: [alpha, beta], sign: 1.0 };
    let square = |cotangent: T| {
        let slope = cotangent * OF_RIGHT_ANGLE;
        [cotangent * slope, slope * 2.0, cotangent.constant(2.0 * OF_RIGHT_ANGLE)]
    };
    angle.expansion_by(inverse_area, area, square)
}

/// An angle between two edges u and v, which change by `slopes` times the move of the visited vertex. The cotangent of
/// the angle is `sign` u·v, divided by the doubled area.
struct Angle<T> {
    u: [T; 2],
    v: [T; 2],
    slopes: [f64; 2],
    sign: f64,
}

impl<T: Real> Angle<T> {
    /// Returns the penalties on the angle. `area` is the gradient of the doubled area, which is linear.
    #[inline(always)]
    fn expansion(&self, inverse_area: T, area: [T; 2]) -> Dual<T> {
        self.expansion_by(inverse_area, area, penalties)
    }

    /// Returns a function of the cotangent of the angle, given the function with its first two derivatives.
    #[inline(always)]
    fn expansion_by(
        &self,
        inverse_area: T,
        area: [T; 2],
        function: impl FnOnce(T) -> [T; 3],
    ) -> Dual<T> {
        let Self { u, v, slopes: [of_u, of_v], sign } = *self;
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
