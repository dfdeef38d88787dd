//! SIMD lanes: four numbers at once, on any processor.
//!
//! Every operation rounds as that of `f64` does, and none are fused, so results depend neither on the processor nor on
//! which numbers share a vector.

use fearless_simd::prelude::*;
use fearless_simd::{f64x4, mask64x4};

use crate::metric::Real;

/// Evaluates an expression with `$f` bound to the formulas of a metric, `$simd` to the best instruction set that the
/// code is compiled for, and the constant `$mapped` to whether triangles are transformed by target maps.
///
/// Each copy of a sweep takes seconds to compile, so only usual cases have a copy of their own, with AVX2 on x86: each
/// usual metric on meshes without targets, and soft-size on meshes with targets, where it takes half the time of the
/// general copy. The general copy serves all else. It looks up the metric for each triangle, which costs imr nothing
/// measurable, and gives meshes without targets identity maps.
macro_rules! with_lanes {
    ($problem:expr, $metric:expr, $simd:ident, $f:ident, $mapped:ident => $body:expr) => {
        'done: {
            let level = fearless_simd::Level::new();
            if $problem.targets().is_none() {
                #[allow(dead_code)]
                const $mapped: bool = false;
                #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
                if let Some($simd) = level.as_avx2() {
                    $crate::metric::with_each_metric!($metric, $f => break 'done (
                        fearless_simd::Simd::vectorize(
                            $simd,
                            #[inline(always)]
                            || $body,
                        )
                    ))
                }
                #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
                $crate::metric::with_each_metric!($metric, $f => break 'done (
                    fearless_simd::dispatch!(level, $simd => $body)
                ))
            }
            const $mapped: bool = true;
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            if let (Some($simd), Some(_), $crate::metric::Metric::SoftSize) =
                (level.as_avx2(), $problem.targets(), $metric)
            {
                #[allow(non_upper_case_globals)]
                const $f: $crate::metric::OfInvariants = $crate::metric::OfInvariants::SoftSize;
                break 'done fearless_simd::Simd::vectorize(
                    $simd,
                    #[inline(always)]
                    || $body,
                );
            }
            let $f = $metric.formulas();
            $crate::cpu::lanes::with_instructions!(level, $simd => $body)
        }
    };
}
pub(crate) use with_lanes;

/// Evaluates an expression with `$simd` bound to the instruction set that it is compiled for: AVX2 on x86 if the processor has it.
macro_rules! with_instructions {
    ($level:expr, $simd:ident => $body:expr) => {{
        let level = $level;
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        match level.as_avx2() {
            Some($simd) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $body,
            ),
            None => {
                let $simd = fearless_simd::Fallback::new();
                $body
            }
        }
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        fearless_simd::dispatch!(level, $simd => $body)
    }};
}
pub(crate) use with_instructions;

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
    #[inline(always)]
    fn apart<R>(self, function: impl FnOnce() -> R) -> R {
        apart(self.simd, function)
    }
}

#[inline(never)]
fn apart<S: Simd, R>(simd: S, function: impl FnOnce() -> R) -> R {
    simd.vectorize(function)
}
