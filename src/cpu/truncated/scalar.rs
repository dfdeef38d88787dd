//! The precision of vectors, terms and levels in a Newton step of all vertices.

use std::ops::{Add, AddAssign, Mul, Neg, Sub};

use crate::run::truncated::aggregation;

/// Single or double precision.
pub(crate) trait Scalar:
    Copy
    + Default
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + AddAssign
{
    /// Share of its diagonal entry that a pivot of a block must exceed. A smaller pivot is rounding of the sums.
    const LEAST_PIVOT: f64;

    fn of(number: f64) -> Self;

    fn wide(self) -> f64;
}

impl Scalar for f32 {
    const LEAST_PIVOT: f64 = aggregation::LEAST_PIVOT;

    #[inline(always)]
    fn of(number: f64) -> Self {
        number as Self
    }

    #[inline(always)]
    fn wide(self) -> f64 {
        self.into()
    }
}

impl Scalar for f64 {
    const LEAST_PIVOT: f64 = 1e-14;

    #[inline(always)]
    fn of(number: f64) -> Self {
        number
    }

    #[inline(always)]
    fn wide(self) -> f64 {
        self
    }
}

/// Returns a vector in another precision.
#[inline(always)]
pub(super) fn narrowed<T: Scalar, const N: usize>(numbers: [f64; N]) -> [T; N] {
    numbers.map(T::of)
}
