//! Arithmetic and comparisons of one number, or of one number in each lane of a SIMD vector.

use std::ops::{BitAnd, BitOr, Not};

use crate::metric::Real;

/// One number, or one number in each lane. A comparison gives one truth value for each number.
pub(crate) trait Numbers: Real {
    /// The truth values: `bool` for `f64`.
    type Mask: Mask;
    /// Returns the same truth value for each number of `self`.
    fn mask(self, value: bool) -> Self::Mask;
    /// Returns whether each number is less than that of `other`. False for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// Returns whether each number is at most that of `other`. False for NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Returns the numbers of `yes` where `mask` is true, and those of `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Returns the absolute values.
    fn abs(self) -> Self;
    /// Returns the numbers with the other sign.
    fn negative(self) -> Self;
}

/// One truth value, or one truth value in each lane.
pub(crate) trait Mask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// Whether all truth values are true.
    fn all(self) -> bool;
    /// Whether all truth values are false.
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
