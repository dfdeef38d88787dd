//! One-sided penalties, and the cotangents of a triangle to which they apply.

use crate::metric::corner::Corner;
use crate::metric::dual::{Dual, Real};

/// A penalty on numbers above a limit: ψ(x - limit), with ψ = 0 for x ≤ 0, and ψ = t³/(3r) + o(r + o) for
/// t = min(x, r) and o = x - t. ψ has two continuous derivatives. It is a cubic up to the ramp r, and a quadratic beyond,
/// so that it grows no faster than the square of the excess.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hinge {
    /// Largest number without a penalty; infinite for no penalty.
    pub(crate) limit: f64,
    /// Width of the cubic part above the limit.
    pub(crate) ramp: f64,
}

impl Hinge {
    /// No penalty.
    pub(crate) const NONE: Self = Self { limit: f64::INFINITY, ramp: f64::INFINITY };
    /// The penalty on the negative cotangents of angles above 78.7 degrees. The ramp ends at the right angle.
    pub(crate) const LARGE_ANGLES: Self = Self { limit: -0.2, ramp: 0.2 };

    /// Returns value, first and second derivative of the penalty at `x`.
    #[inline(always)]
    pub(super) fn at<T: Real>(self, x: T) -> [T; 3] {
        let r = x.constant(self.ramp);
        let excess = (x - self.limit).max(x.constant(0.0));
        let t = excess.min(r);
        let beyond = excess - t;
        [
            t * t * t / x.constant(3.0 * self.ramp) + beyond * (r + beyond),
            t * t / r + beyond * 2.0,
            t * 2.0 / r,
        ]
    }

    /// Returns [`at`](Self::at), and 0 if there is no penalty, also at an infinite number.
    fn given(self, x: f64) -> [f64; 3] {
        if self.limit < f64::INFINITY { self.at(x) } else { [0.0; 3] }
    }

    /// Returns the penalty on `x`.
    pub(crate) fn of(self, x: f64) -> f64 {
        self.given(x)[0]
    }

    /// Returns the penalty on `x` with its derivatives.
    pub(crate) fn expansion(self, x: Dual) -> Dual {
        let [value, first, second] = self.given(x.value);
        x.chain(value, first, second)
    }
}

impl<T: Real> Corner<T> {
    /// Returns the cotangents of the three angles, which rise without bound as the triangle becomes flat. The squared
    /// inverse mean ratio is a third of the sum of their squares, plus 2/3.
    #[inline(always)]
    pub(crate) fn cotangents(&self) -> [T; 3] {
        let ([ax, ay], [bx, by]) = (self.a, self.b);
        let (cx, cy) = (bx - ax, by - ay);
        let per_area = ax.constant(1.0) / self.doubled_area();
        [
            (ax * bx + ay * by) * per_area,
            (ax * cx + ay * cy) * per_area * -1.0,
            (bx * cx + by * cy) * per_area,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::Ideal;

    fn corner<T>(a: [T; 2], b: [T; 2]) -> Corner<T> {
        Corner { a, b, ideal: Ideal::of_area(1.0) }
    }

    #[test]
    fn cotangents_are_those_of_the_angles_and_give_the_inverse_mean_ratio() {
        let right = corner([2.0, 0.0], [0.0, 1.0]).cotangents();
        assert_eq!(right, [0.0, 2.0, 0.5]);
        let (a, b) = ([1.3, -0.2], [0.4, 0.9]);
        let cotangents = corner(a, b).cotangents();
        let angle = cotangents.iter().map(|&x| 1f64.atan2(x).to_degrees()).sum::<f64>();
        assert!((angle - 180.0).abs() < 1e-12);
        let squares = cotangents.iter().map(|x| x * x).sum::<f64>();
        let imr = corner(a, b).inverse_mean_ratio();
        assert!((imr * imr - (squares + 2.0) / 3.0).abs() < 1e-14);
    }

    #[test]
    fn derivatives_of_a_penalty_are_those_of_its_value_and_continuous() {
        let hinge = Hinge { limit: 1.5, ramp: 0.25 };
        assert_eq!([-9.0, 1.5, f64::NEG_INFINITY].map(|x| hinge.of(x)), [0.0; 3]);
        let h = 1e-5;
        for x in [1.4, 1.5, 1.6, 1.75, 2.0, 9.0] {
            let [value, first, second] = hinge.at(x);
            let (left, right) = (hinge.of(x - h), hinge.of(x + h));
            assert!(((right - left) / (2.0 * h) - first).abs() < 1e-7, "{x}");
            assert!(((right - 2.0 * value + left) / (h * h) - second).abs() < 1e-3, "{x}");
        }
        assert_eq!([1e300, f64::INFINITY].map(|x| Hinge::NONE.of(x)), [0.0; 2]);
    }

    #[test]
    fn the_expansion_follows_the_chain_rule() {
        let hinge = Hinge { limit: 0.5, ramp: 0.25 };
        let [x, y] = [(0.7, 0), (0.9, 1)].map(|(at, axis)| Dual::variable(at, axis, 1.0));
        let product = hinge.expansion(x * y);
        let [value, first, second] = hinge.at(0.7 * 0.9);
        assert_eq!(product.value, value);
        assert_eq!(product.gradient, [0.9 * first, 0.7 * first]);
        let cross = second * 0.9 * 0.7 + first;
        assert!((product.hessian[1] - cross).abs() < 1e-12);
    }
}
