//! Smooth replacement of EDGE: a p-norm, with a penalty near the shape guard.

use crate::metric::corner::Corner;
use crate::metric::dual::{Dual, Real};
use crate::metric::edge_slopes::EdgeSlopes;
use crate::metric::slopes::{ShapeSlopes, Slopes};

/// Parameters of the smooth function that replaces EDGE for Newton's method. Smooth metrics ignore them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Smoothing {
    /// Binary logarithm of the exponent k of the p-norm.
    pub(crate) sharpness: u32,
    /// Shape guard that the penalty keeps triangles away from, as an inverse mean ratio; infinite for no penalty.
    pub(crate) penalty_guard: f64,
}

/// Value of the penalty at the shape guard. With a tenth of this value, the guard stops runs again; with ten times the
/// value, runs reach the same f after more sweeps.
pub(crate) const PENALTY: f64 = 0.1;

impl Smoothing {
    /// Returns the smoothing by the p-norm alone, with the exponent 2^`sharpness`.
    pub(crate) fn of(sharpness: u32) -> Self {
        Self { sharpness, penalty_guard: f64::INFINITY }
    }

    /// Returns whether the objective includes a penalty.
    #[inline(always)]
    pub(crate) fn is_penalized(&self) -> bool {
        self.penalty_guard < f64::INFINITY
    }

    /// Returns the penalty [`PENALTY`] · min(imr / guard, 1)^k, with k the exponent of the p-norm. The penalty is
    /// constant beyond the guard, so triangles that start there feel no force from the penalty.
    #[inline(always)]
    pub(super) fn penalty<T: Real>(&self, t: &Corner<T>) -> T {
        let [_, ratio] = self.ratio(t);
        let one = ratio.constant(1.0);
        self.power(ratio.min(one)) * PENALTY
    }

    /// Returns value, gradient and Hessian of [`Self::penalty`] with respect to the visited vertex. `edges` has the
    /// slopes of the edges by the position of the vertex.
    #[inline(always)]
    pub(super) fn penalty_expansion<T: Real>(
        &self,
        t: &Corner<T>,
        edges: impl EdgeSlopes,
    ) -> Dual<T> {
        let [shape, ratio] = self.ratio(t);
        let one = ratio.constant(1.0);
        let value = self.power(ratio.min(one)) * PENALTY;
        // 1 below the guard, even by the least difference of two numbers, and 0 at the guard and beyond.
        let below = ((one - ratio) * 2f64.powi(53)).min(one).max(ratio.constant(0.0));
        let k = f64::from(1u32 << self.sharpness);
        let per_shape = one / (shape + 1.0);
        let first = value * below * per_shape * k;
        let inverse_area = one / t.doubled_area();
        let second = first * per_shape * (k - 1.0);
        ShapeSlopes { inverse_area, shape, value, first, second }.expansion(t, edges)
    }

    /// Returns a triangle's inverse mean ratio minus 1, and the inverse mean ratio divided by the guard.
    #[inline(always)]
    fn ratio<T: Real>(&self, t: &Corner<T>) -> [T; 2] {
        let invariants = t.invariants();
        let shape = invariants.excess / invariants.area;
        [shape, (shape + 1.0) * (1.0 / self.penalty_guard)]
    }

    #[inline(always)]
    fn power<T: Real>(&self, ratio: T) -> T {
        let mut power = ratio;
        for _ in 0..self.sharpness {
            power = power * power;
        }
        power
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::Ideal;
    use crate::metric::edge_slopes::Own;

    fn corner(height: f64) -> Corner<f64> {
        Corner { a: [1.0, 0.1], b: [0.4, height], ideal: Ideal::of_area(0.3) }
    }

    #[test]
    fn the_derivatives_of_the_penalty_are_those_of_its_value() {
        for sharpness in [0, 1, 4, 7, 13] {
            for guard in [1.0004, 1.01, 1.7, 30.0] {
                let smoothing = Smoothing { sharpness, penalty_guard: guard };
                for height in [0.05, 0.3, 0.8660, 0.87, 0.95] {
                    let t = corner(height);
                    let ([ax, ay], [bx, by]) = (t.a, t.b);
                    let [ax, bx] = [ax, bx].map(|x| Dual::variable(x, 0, -1.0));
                    let [ay, by] = [ay, by].map(|y| Dual::variable(y, 1, -1.0));
                    let dual = Corner { a: [ax, ay], b: [bx, by], ideal: t.ideal };
                    let expected = smoothing.penalty(&dual);
                    let found = smoothing.penalty_expansion(&t, Own);
                    let numbers = |d: &Dual| {
                        let ([x, y], [xx, xy, yy]) = (d.gradient, d.hessian);
                        [d.value, x, y, xx, xy, yy]
                    };
                    let k = f64::from(1u32 << sharpness);
                    for (found, expected) in numbers(&found).iter().zip(numbers(&expected)) {
                        let scale = 1e-12 * k * (expected.abs() + 1e-9);
                        assert!((found - expected).abs() <= scale, "{found:e} for {expected:e}");
                    }
                }
            }
        }
    }

    #[test]
    fn beyond_the_guard_the_penalty_is_constant() {
        let smoothing = Smoothing { sharpness: 13, penalty_guard: 2.0 };
        for height in [1e-9, 0.01, 0.1] {
            let t = corner(0.04 + height);
            assert!(t.inverse_mean_ratio() > 2.0);
            assert_eq!(smoothing.penalty(&t), PENALTY);
            let Dual { value, gradient, hessian } = smoothing.penalty_expansion(&t, Own);
            assert_eq!((value, gradient, hessian), (PENALTY, [0.0; 2], [0.0; 3]));
        }
        let near = corner(0.8);
        assert!(near.inverse_mean_ratio() < 1.2);
        assert_eq!(smoothing.penalty(&near), 0.0);
    }
}
