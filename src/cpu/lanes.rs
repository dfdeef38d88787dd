//! Four numbers that are computed with at once, whatever the processor has for it.
//!
//! Every operation rounds as that of `f64` does and none are fused, so results do not depend on
//! the processor, nor on which numbers stand beside each other.

use fearless_simd::prelude::*;
use fearless_simd::{f64x4, mask64x4};

use crate::metric::Real;

/// Numbers side by side.
pub(crate) const LANES: usize = 4;

/// Four numbers, for the instructions that `S` says the processor has.
pub(crate) type Lanes<S> = f64x4<S>;
/// Four truth values.
pub(crate) type Mask<S> = mask64x4<S>;
/// Four vectors of the plane.
pub(crate) type Points<S> = [Lanes<S>; 2];

impl<S: Simd> Real for Lanes<S> {
    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }
    #[inline(always)]
    fn fixed(self) -> Self {
        self
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        SimdFloat::sqrt(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        SimdFloat::min(self, other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        SimdFloat::max(self, other)
    }
}
