//! SIMD lanes: four numbers at once, on any processor.
//!
//! Every operation rounds as that of `f64` does and none are fused, so results depend neither on
//! the processor nor on which numbers share a vector.

use fearless_simd::prelude::*;
use fearless_simd::{f64x4, mask64x4};

use crate::metric::Real;

/// Evaluates an expression with `$f` bound to the formulas of a metric and `$simd` to the best instructions that the code
/// is compiled for. On x86 these are those of AVX2, for each metric by itself. Processors without them get code that
/// any can run, compiled once for all metrics but EDGE: each copy of a sweep takes seconds to compile.
macro_rules! with_lanes {
    ($metric:expr, $simd:ident, $f:ident => $body:expr) => {{
        let level = fearless_simd::Level::new();
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        match level.as_avx2() {
            Some($simd) => $crate::metric::with_each_metric!($metric, $f => {
                fearless_simd::Simd::vectorize(
                    $simd,
                    #[inline(always)]
                    || $body,
                )
            }),
            None => $crate::metric::with_formulas!($metric, $f => {
                let $simd = fearless_simd::Fallback::new();
                $body
            }),
        }
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        $crate::metric::with_each_metric!($metric, $f => {
            fearless_simd::dispatch!(level, $simd => $body)
        })
    }};
}
pub(crate) use with_lanes;

/// Number of lanes.
pub(crate) const LANES: usize = 4;

/// Four numbers, computed with the instruction set `S`.
pub(crate) type Lanes<S> = f64x4<S>;
/// Four truth values.
pub(crate) type Mask<S> = mask64x4<S>;
/// Four points or vectors of the plane, as x and y.
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
