//! Numbers that carry their first and second derivatives.
//!
//! The CPU engine differentiates each metric's *value formula* with these, so a mistake in the
//! hand-written WGSL derivatives cannot hide in both engines.

use std::ops::{Add, Div, Mul, Sub};

/// What a metric's value formula may do with its arguments: `f64` for values, [`Dual`] for
/// derivatives.
pub trait Real:
    Copy + From<f64> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The value without its derivatives.
    fn value(self) -> f64;
    /// The square root; the derivative at zero is infinite.
    fn sqrt(self) -> Self;
}

impl Real for f64 {
    fn value(self) -> f64 {
        self
    }
    fn sqrt(self) -> Self {
        self.sqrt()
    }
}

/// A function of two variables at a point: value, gradient and Hessian.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dual {
    /// The value.
    pub value: f64,
    /// First derivatives by x and y.
    pub gradient: [f64; 2],
    /// Second derivatives xx, xy, yy.
    pub hessian: [f64; 3],
}

impl Dual {
    /// The variable x (`axis` 0) or y (`axis` 1), times `slope`, at `value`.
    pub fn variable(value: f64, axis: usize, slope: f64) -> Self {
        let mut gradient = [0.0; 2];
        gradient[axis] = slope;
        Self { value, gradient, hessian: [0.0; 3] }
    }

    /// `f(self)` by the chain rule, from the value and the two derivatives of `f` there.
    #[inline(always)]
    fn chain(self, f: f64, df: f64, ddf: f64) -> Self {
        let [x, y] = self.gradient;
        let [xx, xy, yy] = self.hessian;
        Self {
            value: f,
            gradient: [df * x, df * y],
            hessian: [ddf * x * x + df * xx, ddf * x * y + df * xy, ddf * y * y + df * yy],
        }
    }
}

impl From<f64> for Dual {
    fn from(value: f64) -> Self {
        Self { value, ..Self::default() }
    }
}

impl Add for Dual {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self {
            value: self.value + o.value,
            gradient: std::array::from_fn(|i| self.gradient[i] + o.gradient[i]),
            hessian: std::array::from_fn(|i| self.hessian[i] + o.hessian[i]),
        }
    }
}

impl Sub for Dual {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self {
            value: self.value - o.value,
            gradient: std::array::from_fn(|i| self.gradient[i] - o.gradient[i]),
            hessian: std::array::from_fn(|i| self.hessian[i] - o.hessian[i]),
        }
    }
}

impl Mul for Dual {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        let ([ax, ay], [bx, by]) = (self.gradient, o.gradient);
        let cross = [2.0 * ax * bx, ax * by + ay * bx, 2.0 * ay * by];
        Self {
            value: self.value * o.value,
            gradient: std::array::from_fn(|i| {
                self.gradient[i] * o.value + self.value * o.gradient[i]
            }),
            hessian: std::array::from_fn(|i| {
                self.hessian[i] * o.value + cross[i] + self.value * o.hessian[i]
            }),
        }
    }
}

impl Div for Dual {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let r = 1.0 / o.value;
        self * o.chain(r, -r * r, 2.0 * r * r * r)
    }
}

impl Real for Dual {
    #[inline(always)]
    fn value(self) -> f64 {
        self.value
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let s = self.value.sqrt();
        self.chain(s, 0.5 / s, -0.25 / (s * self.value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_a_known_function() {
        // f = sqrt(x y) / (x - y) at (3, 1), derivatives by hand.
        let (x, y) = (Dual::variable(3.0, 0, 1.0), Dual::variable(1.0, 1, 1.0));
        let f = (x * y).sqrt() / (x - y);
        let (s, d) = (3f64.sqrt(), 2.0);
        assert!((f.value - s / d).abs() < 1e-15);
        let (fx, fy) = (1.0 / (2.0 * s * d) - s / 4.0, 3.0 / (2.0 * s * d) + s / 4.0);
        assert!((f.gradient[0] - fx).abs() < 1e-15 && (f.gradient[1] - fy).abs() < 1e-15);
        let h = 1e-4;
        let value = |x: f64, y: f64| (x * y).sqrt() / (x - y);
        let xx = (value(3.0 + h, 1.0) - 2.0 * value(3.0, 1.0) + value(3.0 - h, 1.0)) / (h * h);
        let yy = (value(3.0, 1.0 + h) - 2.0 * value(3.0, 1.0) + value(3.0, 1.0 - h)) / (h * h);
        let xy = (value(3.0 + h, 1.0 + h) - value(3.0 + h, 1.0 - h) - value(3.0 - h, 1.0 + h)
            + value(3.0 - h, 1.0 - h))
            / (4.0 * h * h);
        for (got, want) in f.hessian.into_iter().zip([xx, xy, yy]) {
            assert!((got - want).abs() < 1e-6, "{got} {want}");
        }
    }
}
