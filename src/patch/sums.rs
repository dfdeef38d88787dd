//! Sums over triangles that are handled four at once, or one alone.

use crate::patch::lanes::{LANES, Width};
use crate::patch::numbers::Numbers;

/// Returns the triangles that are handled at once, from a lane of four on. Triangles alone are repeated.
#[inline(always)]
pub(crate) fn from_lane<W: Width>(four: &[[u32; 3]; LANES], lane: usize) -> [[u32; 3]; LANES] {
    if W::Numbers::LANES == LANES { *four } else { [four[lane]; LANES] }
}

/// The sums of numbers over every fourth triangle. Their bits do not depend on how many triangles are handled at once.
pub(crate) struct Sums<T>([T; LANES]);

impl<T: Numbers> Sums<T> {
    /// Returns sums of zero.
    #[inline(always)]
    pub(crate) fn new(width: impl Width<Numbers = T>) -> Self {
        Self([width.splat(0.0); LANES])
    }

    /// Adds the numbers of the triangles from a lane on.
    #[inline(always)]
    pub(crate) fn add(&mut self, lane: usize, numbers: T) {
        self.0[lane] = self.0[lane] + numbers;
    }

    /// Returns the sum over all triangles.
    #[inline(always)]
    pub(crate) fn total(&self) -> f64 {
        let of = |lane: usize| self.0[lane / T::LANES * T::LANES].lane(lane % T::LANES);
        (of(0) + of(1)) + (of(2) + of(3))
    }
}
