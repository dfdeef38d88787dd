//! Dual numbers: values that carry their first and second derivatives.
//!
//! Tests differentiate the *value formula* of each metric with dual numbers, and compare every hand-written derivative
//! with the result, both in WGSL and in Rust. The engines use the hand-written derivatives, and [`Dual`] only to hold
//! their values.

use std::ops::{Add, Div, Mul, Sub};

/// The arithmetic of a metric's formulas. `f64` and SIMD vectors of `f64` implement the trait for values, [`Dual`] for
/// derivatives.
///
/// Formulas avoid closures and iterators over such numbers: calls through the standard library are not compiled for
/// SIMD instructions, which makes them several times slower.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// Returns the constant `value`, with as many lanes as `self`.
    fn constant(self, value: f64) -> Self;
    /// Returns the value of `self` as a constant, with zero derivatives.
    fn fixed(self) -> Self;
    /// Returns the square root, whose derivative at zero is infinite.
    fn sqrt(self) -> Self;
    /// Returns the smaller of two numbers.
    fn min(self, other: Self) -> Self;
    /// Returns the larger of two numbers.
    fn max(self, other: Self) -> Self;
    /// Calls a function of numbers of this type. The function is compiled as separate code (for SIMD vectors with their
    /// instructions), so that callers stay small enough to be compiled in seconds.
    #[inline(always)]
    fn apart<R>(self, function: impl FnOnce() -> R) -> R {
        function()
    }
}

impl Real for f64 {
    fn constant(self, value: f64) -> Self {
        value
    }
    fn fixed(self) -> Self {
        self
    }
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    fn min(self, other: Self) -> Self {
        self.min(other)
    }
    fn max(self, other: Self) -> Self {
        self.max(other)
    }
    #[inline(never)]
    fn apart<R>(self, function: impl FnOnce() -> R) -> R {
        function()
    }
}

/// A function of two variables at a point: value, gradient and Hessian.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dual<T = f64> {
    /// The value.
    pub value: T,
    /// First derivatives by x and y.
    pub gradient: [T; 2],
    /// Second derivatives xx, xy, yy.
    pub hessian: [T; 3],
}

impl<T: Real> Dual<T> {
    /// Returns the variable x (`axis` 0) or y (`axis` 1), times `slope`, at `value`.
    #[inline(always)]
    pub fn variable(value: T, axis: usize, slope: f64) -> Self {
        let mut dual = Self::of(value);
        dual.gradient[axis] = value.constant(slope);
        dual
    }

    /// Returns the constant `value`.
    #[inline(always)]
    fn of(value: T) -> Self {
        let zero = value.constant(0.0);
        Self { value, gradient: [zero; 2], hessian: [zero; 3] }
    }

    /// Returns `f(self)` by the chain rule, from the value of f and its first two derivatives at `self`.
    #[inline(always)]
    pub(crate) fn chain(self, f: T, df: T, ddf: T) -> Self {
        let [x, y] = self.gradient;
        let [xx, xy, yy] = self.hessian;
        Self {
            value: f,
            gradient: [df * x, df * y],
            hessian: [ddf * x * x + df * xx, ddf * x * y + df * xy, ddf * y * y + df * yy],
        }
    }
}

impl<T: Real> Add for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        let ([x, y], [xx, xy, yy]) = (self.gradient, self.hessian);
        let ([ox, oy], [oxx, oxy, oyy]) = (o.gradient, o.hessian);
        Self {
            value: self.value + o.value,
            gradient: [x + ox, y + oy],
            hessian: [xx + oxx, xy + oxy, yy + oyy],
        }
    }
}

impl<T: Real> Sub for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        let ([x, y], [xx, xy, yy]) = (self.gradient, self.hessian);
        let ([ox, oy], [oxx, oxy, oyy]) = (o.gradient, o.hessian);
        Self {
            value: self.value - o.value,
            gradient: [x - ox, y - oy],
            hessian: [xx - oxx, xy - oxy, yy - oyy],
        }
    }
}

impl<T: Real> Mul for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        let (a, [ax, ay], [axx, axy, ayy]) = (self.value, self.gradient, self.hessian);
        let (b, [bx, by], [bxx, bxy, byy]) = (o.value, o.gradient, o.hessian);
        Self {
            value: a * b,
            gradient: [ax * b + a * bx, ay * b + a * by],
            hessian: [
                axx * b + ax * bx * 2.0 + a * bxx,
                axy * b + (ax * by + ay * bx) + a * bxy,
                ayy * b + ay * by * 2.0 + a * byy,
            ],
        }
    }
}

impl<T: Real> Div for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let r = o.value.constant(1.0) / o.value;
        let rr = r * r;
        self * o.chain(r, rr * -1.0, rr * r * 2.0)
    }
}

impl<T: Real> Add<f64> for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, constant: f64) -> Self {
        Self { value: self.value + constant, ..self }
    }
}

impl<T: Real> Sub<f64> for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, constant: f64) -> Self {
        Self { value: self.value - constant, ..self }
    }
}

impl<T: Real> Mul<f64> for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        let ([x, y], [xx, xy, yy]) = (self.gradient, self.hessian);
        Self {
            value: self.value * factor,
            gradient: [x * factor, y * factor],
            hessian: [xx * factor, xy * factor, yy * factor],
        }
    }
}

impl<T: Real> Dual<T> {
    /// Returns a number with the value `value`, and the derivatives of `one` if `chooses_one` is 1, or of `other` if it
    /// is 0.
    #[inline(always)]
    fn chosen(value: T, chooses_one: T, one: Self, other: Self) -> Self {
        let chosen = |one: T, other: T| other + (one - other) * chooses_one;
        let ([x, y], [xx, xy, yy]) = (one.gradient, one.hessian);
        let ([ox, oy], [oxx, oxy, oyy]) = (other.gradient, other.hessian);
        Self {
            value,
            gradient: [chosen(x, ox), chosen(y, oy)],
            hessian: [chosen(xx, oxx), chosen(xy, oxy), chosen(yy, oyy)],
        }
    }
}

/// Returns 1 for a positive number, even the least difference of two numbers near 1, and 0 for zero and negative numbers.
#[inline(always)]
fn step<T: Real>(x: T) -> T {
    (x * 2f64.powi(1000)).min(x.constant(1.0)).max(x.constant(0.0))
}

/// Numbers with derivatives. `min` and `max` return the derivatives of the number that they choose, and those of `other`
/// if both numbers are equal.
impl<T: Real> Real for Dual<T> {
    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Self::of(self.value.constant(value))
    }
    #[inline(always)]
    fn fixed(self) -> Self {
        Self::of(self.value)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let s = self.value.sqrt();
        let half = s.constant(0.5) / s;
        self.chain(s, half, half * -0.5 / self.value)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::chosen(self.value.min(other.value), step(other.value - self.value), self, other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::chosen(self.value.max(other.value), step(self.value - other.value), self, other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_a_known_function() {
        // f = sqrt(x y) / (x - y) at (3, 1), with derivatives by hand.
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
