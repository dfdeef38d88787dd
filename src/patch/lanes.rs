//! SIMD lanes: four numbers at once, on any processor.
//!
//! Every operation rounds like the operation of `f64`, and none are fused, so results depend neither on the processor
//! nor on which numbers share a vector.

use fearless_simd::prelude::*;
use fearless_simd::{Level, f64x4, mask64x4};
use glam::DVec2;

use crate::metric::Real;
use crate::patch::numbers::{self, Numbers};

/// Returns the instructions of this processor, but those of any processor of the target on threads of a test that leaves vectors
/// out.
#[inline(always)]
pub(crate) fn level() -> Level {
    #[cfg(test)]
    if ARE_VECTORS_LEFT_OUT.get() {
        return Level::baseline();
    }
    Level::new()
}

/// Evaluates an expression with `$f` bound to the formulas of a metric, `$simd` to the best instruction set for which
/// the code is compiled, and the constant `$general` to whether the copy of the code serves target maps and bounds.
///
/// Each copy of a sweep takes seconds to compile, without vector instructions minutes. So only usual cases have a copy of their own,
/// with the instructions of [`HAS_COPIES`]: each usual metric on meshes without targets and bounds, and on x86 soft-size on meshes
/// with targets, where its copy takes half the time of the copy for all metrics. The copy for all metrics serves all other cases.
/// It looks up the metric for each triangle, which costs imr nothing measurable, and gives meshes without targets identity maps.
macro_rules! with_lanes {
    ($maps:expr, $bounded:expr, $metric:expr, $simd:ident, $f:ident, $general:ident => $body:expr) => {
        'done: {
            let level = $crate::patch::lanes::level();
            if $crate::patch::lanes::HAS_COPIES && $maps.is_none() && !$bounded {
                #[allow(dead_code)]
                const $general: bool = false;
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
            const $general: bool = true;
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            if let (Some($simd), Some(_), $crate::metric::Metric::SoftSize) =
                (level.as_avx2(), $maps, $metric)
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
            $crate::patch::lanes::with_instructions!($simd => $body)
        }
    };
}
pub(crate) use with_lanes;

/// Evaluates an expression with `$simd` bound to the instruction set for which the expression is compiled: AVX2 on x86
/// if the processor has AVX2.
///
/// On a processor without such instructions, the expression `$alone` is evaluated if the call has one. Vectors that a processor
/// lacks are compiled to single numbers, which takes minutes for large code, so large code has a form of its own there.
macro_rules! with_instructions {
    ($simd:ident => $body:expr, alone => $alone:expr) => {{
        let level = $crate::patch::lanes::level();
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        match level.as_avx2() {
            Some($simd) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $body,
            ),
            None => $alone,
        }
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        match level.is_fallback() {
            true => $alone,
            false => fearless_simd::dispatch!(level, $simd => $body),
        }
    }};
    ($simd:ident => $body:expr) => {{
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            $crate::patch::lanes::with_instructions!($simd => $body, alone => {
                let $simd = fearless_simd::Fallback::new();
                $body
            })
        }
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        {
            fearless_simd::dispatch!($crate::patch::lanes::level(), $simd => $body)
        }
    }};
}
pub(crate) use with_instructions;

/// Whether usual cases have copies of their own: with AVX2 on x86, with Neon on 64-bit ARM, and with `simd128` in WebAssembly.
pub(crate) const HAS_COPIES: bool = cfg!(any(
    target_arch = "x86",
    target_arch = "x86_64",
    target_arch = "aarch64",
    target_feature = "simd128"
));

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

impl<S: Simd> numbers::Mask for Mask<S> {
    #[inline(always)]
    fn all(self) -> bool {
        self.all_true()
    }
    #[inline(always)]
    fn none(self) -> bool {
        self.all_false()
    }
}

impl<S: Simd> Numbers for Lanes<S> {
    type Mask = Mask<S>;
    #[inline(always)]
    fn mask(self, value: bool) -> Mask<S> {
        Mask::splat(self.simd, value)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Mask<S> {
        self.simd_lt(other)
    }
    #[inline(always)]
    fn le(self, other: Self) -> Mask<S> {
        self.simd_le(other)
    }
    #[inline(always)]
    fn select(mask: Mask<S>, yes: Self, no: Self) -> Self {
        mask.select(yes, no)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        SimdFloat::abs(self)
    }
    #[inline(always)]
    fn negative(self) -> Self {
        -self
    }
}

/// Calls a function that is compiled as separate code with the instructions of `simd`; see [`Real::apart`].
#[inline(never)]
pub(crate) fn apart<S: Simd, R>(simd: S, function: impl FnOnce() -> R) -> R {
    simd.vectorize(function)
}

/// Gathers the positions of four vertices into lanes.
#[inline(always)]
pub(crate) fn points<S: Simd>(simd: S, positions: &[DVec2], vertices: [u32; LANES]) -> Points<S> {
    let [a, b, c, d] = vertices;
    let (a, b) = (positions[a as usize].as_ref(), positions[b as usize].as_ref());
    in_lanes(simd, [a, b, positions[c as usize].as_ref(), positions[d as usize].as_ref()])
}

/// Returns four points, one in each lane.
#[inline(always)]
pub(crate) fn in_lanes<S: Simd>(simd: S, [a, b, c, d]: [&[f64; 2]; LANES]) -> Points<S> {
    // Whole points are loaded and then shuffled. Lanes made of an array of coordinates would be written to memory one by one
    // and read back at once, for which a processor has to wait.
    let (a, b) = (simd.load_array_ref_f64x2(a), simd.load_array_ref_f64x2(b));
    let (c, d) = (simd.load_array_ref_f64x2(c), simd.load_array_ref_f64x2(d));
    let (ab, cd) = (a.combine(b), c.combine(d));
    [ab.unzip_low(cd), ab.unzip_high(cd)]
}

/// Gathers the numbers of four vertices into lanes.
#[inline(always)]
pub(crate) fn numbers<S: Simd>(simd: S, numbers: &[f64], vertices: [u32; LANES]) -> Lanes<S> {
    let [a, b, c, d] = vertices;
    let (a, b) = (numbers[a as usize], numbers[b as usize]);
    Lanes::simd_from(simd, [a, b, numbers[c as usize], numbers[d as usize]])
}

/// Gathers the target maps of four vertices into lanes; identities if the mesh has no targets.
#[inline(always)]
pub(crate) fn vertex_maps<S: Simd>(
    simd: S,
    maps: Option<&[[f32; 3]]>,
    vertices: [u32; LANES],
) -> [Lanes<S>; 3] {
    let Some(maps) = maps else {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        return [one, zero, one];
    };
    let [a, b, c, d] = vertices;
    let (a, b) = (&maps[a as usize], &maps[b as usize]);
    let (c, d) = (&maps[c as usize], &maps[d as usize]);
    // A loop over lanes instead of `map` of arrays, which is not inlined here and would take a third of a sweep.
    let lane = |i: usize| {
        let numbers = [f64::from(a[i]), f64::from(b[i]), f64::from(c[i]), f64::from(d[i])];
        Lanes::simd_from(simd, numbers)
    };
    [lane(0), lane(1), lane(2)]
}

#[cfg(test)]
thread_local! {
    static ARE_VECTORS_LEFT_OUT: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

/// Calls a function twice, on threads of its own: with vector instructions, and with the instructions of any processor of the
/// target. Without optimization, runs in lanes take more stack than threads usually have.
#[cfg(test)]
pub(crate) fn with_and_without_vectors<R: Send>(of: impl Fn() -> R + Send + Sync) -> [R; 2] {
    [false, true].map(|are_left_out| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(2)
            .stack_size(1 << 26)
            .start_handler(move |_| ARE_VECTORS_LEFT_OUT.set(are_left_out))
            .build();
        pool.unwrap().install(&of)
    })
}
