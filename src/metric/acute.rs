//! The metric ACUTE, for solvers with unknowns at circumcenters: the inverse mean ratio, with penalties on nearly right,
//! obtuse and small angles.

use crate::metric::corner::Corner;
use crate::metric::dual::{Dual, Real};
use crate::metric::edge_slopes::EdgeSlopes;
use crate::metric::hinge::Hinge;
use crate::metric::imr;
use crate::metric::properties::Properties;

pub(super) const PROPERTIES: Properties = Properties {
    name: "acute",
    formula: "sqrt(imr² + 300 Σ ψ(0.2 - cot) + 30 Σ ψ(cot - 1.3)), ψ(x) = x³ / 0.6 up to x = 0.2, quadratic beyond",
    citation: "imr² = (Σ cot² + 2) / 3 as in imr, and gpu-smooth's own penalties on the cotangents of the angles",
    purpose: "orthogonal meshes for solvers with unknowns at circumcenters: acute angles first, then well-shaped triangles",
    barrier: true,
    ideal: 1.0,
    least: 1.0,
    scale_invariant: true,
    has_size_weight: false,
    is_inverse_mean_ratio: false,
    quadratic: false,
    eigenvalue_floor: 1e-3,
    shape_guard: f64::INFINITY,
    omega: 1.9,
    is_corrected: true,
    wgsl: include_str!("acute.wgsl"),
};

/// Weight of the penalty on large angles.
const LARGE_WEIGHT: f64 = 300.0;
/// The penalty on the cotangents of angles below 37.6 degrees, and its weight.
const SMALL: Hinge = Hinge { limit: 1.3, ramp: 0.2 };
const SMALL_WEIGHT: f64 = 30.0;

/// Returns q² - 1.
#[inline(always)]
pub(super) fn excess<T: Real>(t: &Corner<T>) -> T {
    let [a, b, c] = t.cotangents();
    let ([a, _, _], [b, _, _], [c, _, _]) = (penalties(a), penalties(b), penalties(c));
    imr::value(&t.invariants()) + (a + b + c)
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

/// Returns value, gradient and Hessian of [`excess`] with respect to the visited vertex. `edges` has the slopes of the
/// edges by the position of the vertex.
#[inline(always)]
pub(super) fn expansion<T: Real>(t: &Corner<T>, edges: impl EdgeSlopes) -> Dual<T> {
    let (a, b) = (t.a, t.b);
    let c = [b[0] - a[0], b[1] - a[1]];
    let (alpha, beta, gamma) = (edges.alpha(), edges.beta(), edges.third());
    let inverse_area = a[0].constant(1.0) / t.doubled_area();
    let area = [b[1] * alpha - a[1] * beta, a[0] * beta - b[0] * alpha];
    let shape = t.expansion(edges, &imr::slopes(&t.invariants()));
    // The cotangents are a·b, -a·c and b·c, divided by the doubled area.
    let one = Angle { u: a, v: b, slopes: [alpha, beta], sign: 1.0 };
    let two = Angle { u: a, v: c, slopes: [alpha, gamma], sign: -1.0 };
    let three = Angle { u: b, v: c, slopes: [beta, gamma], sign: 1.0 };
    let (one, two) = (one.expansion(inverse_area, area), two.expansion(inverse_area, area));
    shape + (one + two + three.expansion(inverse_area, area))
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
        let Self { u, v, slopes: [of_u, of_v], sign } = *self;
        let (of_u, of_v) = (of_u * sign, of_v * sign);
        let cotangent = (u[0] * v[0] + u[1] * v[1]) * inverse_area * sign;
        let [value, first, second] = penalties(cotangent);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::{Ideal, Metric};

    fn corner(a: [f64; 2], b: [f64; 2]) -> Corner<f64> {
        Corner { a, b, ideal: Ideal::of_area(1.0) }
    }

    #[test]
    fn between_38_and_78_degrees_the_metric_is_the_inverse_mean_ratio() {
        let good = corner([1.0, 0.0], [0.45, 0.75]);
        assert_eq!(Metric::Acute.quality(&good), Metric::Imr.quality(&good));
        let right = corner([1.0, 0.0], [0.0, 1.0]);
        // At the right angle, the ramp of 0.2 ends: ψ = 0.2² / 3.
        let expected = (4.0 / 3.0 + 300.0 * 0.04 / 3.0f64).sqrt();
        assert!((Metric::Acute.quality(&right) - expected).abs() < 1e-14);
        let thin = corner([1.0, 0.0], [0.5, 3.0]);
        assert!(Metric::Acute.quality(&thin) > 2.0 * Metric::Imr.quality(&thin));
    }
}
