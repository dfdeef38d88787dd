//! Arithmetic and comparisons of scalars and SIMD vectors.

use std::ops::{BitAnd, BitOr, Not};

use crate::metric::Real;

/// A scalar, or a SIMD vector with one number per lane. Comparisons return a mask with one truth value per number.
pub(crate) trait Numbers: Real {
    /// Type of truth values: `bool` for `f64`.
    type Mask: Mask;
    /// Number of lanes: 1 for `f64`.
    const LANES: usize;
    /// Returns the number in a lane.
    fn lane(self, lane: usize) -> f64;
    /// Sets the number in a lane.
    fn set_lane(&mut self, lane: usize, number: f64);
    /// Returns a mask with `value` in every lane.
    fn mask(self, value: bool) -> Self::Mask;
    /// Compares by `<`, lane by lane: NaN gives false.
    fn lt(self, other: Self) -> Self::Mask;
    /// Compares by `<=`, lane by lane: NaN gives false.
    fn le(self, other: Self) -> Self::Mask;
    /// Returns `yes` in lanes where `mask` is true, and `no` in other lanes.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Returns absolute values.
    fn abs(self) -> Self;
    /// Returns numbers with the opposite sign.
    fn negative(self) -> Self;
}

/// A truth value, or a SIMD mask with one truth value per lane.
pub(crate) trait Mask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// Returns whether all truth values are true.
    fn all(self) -> bool;
    /// Returns whether all truth values are false.
    fn none(self) -> bool;
}

impl Mask for bool {
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
    #[inline(always)]
    fn none(self) -> bool {
        !self
    }
}

impl Numbers for f64 {
    type Mask = bool;
    const LANES: usize = 1;
    #[inline(always)]
    fn lane(self, _: usize) -> f64 {
        self
    }
    #[inline(always)]
    fn set_lane(&mut self, _: usize, number: f64) {
        *self = number;
    }
    #[inline(always)]
    fn mask(self, value: bool) -> bool {
        value
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn negative(self) -> Self {
        -self
    }
}
