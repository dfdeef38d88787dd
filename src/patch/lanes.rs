//! SIMD lanes: four numbers at once on a processor with vector instructions, and one number alone on others.
//!
//! Every operation rounds like the operation of `f64`, and none are fused, so results depend neither on the processor
//! nor on which numbers share a vector.

use fearless_simd::prelude::*;
use fearless_simd::{Level, f64x4, mask64x4};
use glam::DVec2;

use crate::metric::Real;
use crate::patch::numbers::{self, Numbers};

/// The vector instructions for which code is compiled: AVX2 on x86, Neon on 64-bit ARM, and `simd128` in WebAssembly.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
type Vectors = fearless_simd::Avx2;
#[cfg(target_arch = "aarch64")]
type Vectors = fearless_simd::Neon;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
type Vectors = fearless_simd::WasmSimd128;
#[cfg(not(any(
    target_arch = "x86",
    target_arch = "x86_64",
    target_arch = "aarch64",
    all(target_arch = "wasm32", target_feature = "simd128")
)))]
type Vectors = fearless_simd::Fallback;

/// The vector instructions of older processors, for which one copy of the code is compiled: SSE4.2 on x86.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
type OlderVectors = fearless_simd::Sse4_2;
#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
type OlderVectors = fearless_simd::Fallback;

/// Whether code is compiled for [`Vectors`].
pub(crate) const HAS_VECTORS: bool = cfg!(any(
    target_arch = "x86",
    target_arch = "x86_64",
    target_arch = "aarch64",
    target_feature = "simd128"
));

/// Whether code is compiled for [`OlderVectors`].
pub(crate) const HAS_OLDER_VECTORS: bool = cfg!(any(target_arch = "x86", target_arch = "x86_64"));

/// Returns the vector instructions of this processor. `None` on a processor without them, and on threads of a test that leaves
/// them out.
#[inline(always)]
pub(crate) fn vectors() -> Option<Vectors> {
    #[cfg(test)]
    if LEFT_OUT.get() > 0 {
        return None;
    }
    let level = Level::new();
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    return level.as_avx2();
    #[cfg(target_arch = "aarch64")]
    return level.as_neon();
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    return level.as_wasm_simd128();
    #[allow(unreachable_code)]
    {
        let _ = level;
        None
    }
}

/// Returns the vector instructions of this processor if it is older. `None` on a processor without them.
#[inline(always)]
pub(crate) fn older_vectors() -> Option<OlderVectors> {
    #[cfg(test)]
    if LEFT_OUT.get() > 1 {
        return None;
    }
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    return Level::new().as_sse4_2();
    #[allow(unreachable_code)]
    None
}

/// Evaluates an expression with `$f` bound to the formulas of a metric, `$width` to the [`Width`] of this processor, and the constant
/// `$general` to whether the copy of the code serves target maps and bounds.
///
/// Each copy of a sweep takes seconds to compile. So only usual cases have a copy of their own, with vector instructions: each usual
/// metric on meshes without targets and bounds, and on x86 soft-size on meshes with targets, where its copy takes half the time of the
/// copy for all metrics. The copy for all metrics serves all other cases. It looks up the metric for each triangle, which costs imr
/// nothing measurable, and gives meshes without targets identity maps.
macro_rules! with_lanes {
    ($maps:expr, $bounded:expr, $metric:expr, $width:ident, $f:ident, $general:ident => $body:expr) => {
        'done: {
            if $crate::patch::lanes::HAS_VECTORS
                && let (Some($width), None, false) =
                    ($crate::patch::lanes::vectors(), $maps, $bounded)
            {
                #[allow(dead_code)]
                const $general: bool = false;
                $crate::metric::with_each_metric!($metric, $f => break 'done (
                    $crate::patch::lanes::Width::compiled(
                        $width,
                        #[inline(always)]
                        || $body,
                    )
                ))
            }
            const $general: bool = true;
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            if let (Some($width), Some(_), $crate::metric::Metric::SoftSize) =
                ($crate::patch::lanes::vectors(), $maps, $metric)
            {
                #[allow(non_upper_case_globals)]
                const $f: $crate::metric::OfInvariants = $crate::metric::OfInvariants::SoftSize;
                break 'done $crate::patch::lanes::Width::compiled(
                    $width,
                    #[inline(always)]
                    || $body,
                );
            }
            let $f = $metric.formulas();
            $crate::patch::lanes::with_instructions!($width => $body)
        }
    };
}
pub(crate) use with_lanes;

/// Evaluates an expression with `$width` bound to the vector instructions of this processor. On a processor without them, evaluates
/// the expression `$alone`, or the same expression with `$width` bound to [`Alone`].
macro_rules! with_instructions {
    ($width:ident => $body:expr, alone => $alone:expr) => {
        // The first conditions are decided at compile time, so code for vectors that a target lacks is left out.
        if $crate::patch::lanes::HAS_VECTORS
            && let Some($width) = $crate::patch::lanes::vectors()
        {
            $crate::patch::lanes::Width::compiled(
                $width,
                #[inline(always)]
                || $body,
            )
        } else if $crate::patch::lanes::HAS_OLDER_VECTORS
            && let Some($width) = $crate::patch::lanes::older_vectors()
        {
            $crate::patch::lanes::Width::compiled(
                $width,
                #[inline(always)]
                || $body,
            )
        } else {
            $alone
        }
    };
    ($width:ident => $body:expr) => {
        $crate::patch::lanes::with_instructions!($width => $body, alone => {
            let $width = $crate::patch::lanes::Alone;
            $body
        })
    };
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

/// The vertices or triangles that code handles at once: four in vectors, by the instructions of a [`Simd`], or one, by [`Alone`].
///
/// On a processor without vector instructions, a vector of four would be compiled to four single numbers side by side. That took the
/// compiler a minute and a half for this crate, so code handles one vertex or triangle at a time there.
pub(crate) trait Width: Copy {
    /// A number for each of them.
    type Numbers: Numbers;
    /// Returns a number in each lane.
    fn splat(self, number: f64) -> Self::Numbers;
    /// Returns numbers, one in each lane. A single number is the first.
    fn in_lanes(self, numbers: [f64; LANES]) -> Self::Numbers;
    /// Returns points, one in each lane. A single point is the first.
    fn points_in_lanes(self, points: [&[f64; 2]; LANES]) -> [Self::Numbers; 2];
    /// Calls a function that is compiled with the instructions.
    fn compiled<R>(self, function: impl FnOnce() -> R) -> R;
}

/// One vertex or triangle at a time.
#[derive(Clone, Copy)]
pub(crate) struct Alone;

impl Width for Alone {
    type Numbers = f64;
    #[inline(always)]
    fn splat(self, number: f64) -> f64 {
        number
    }
    #[inline(always)]
    fn in_lanes(self, numbers: [f64; LANES]) -> f64 {
        numbers[0]
    }
    #[inline(always)]
    fn points_in_lanes(self, points: [&[f64; 2]; LANES]) -> [f64; 2] {
        *points[0]
    }
    #[inline(always)]
    fn compiled<R>(self, function: impl FnOnce() -> R) -> R {
        function()
    }
}

impl<S: Simd> Width for S {
    type Numbers = Lanes<S>;
    #[inline(always)]
    fn splat(self, number: f64) -> Lanes<S> {
        Lanes::splat(self, number)
    }
    #[inline(always)]
    fn in_lanes(self, numbers: [f64; LANES]) -> Lanes<S> {
        Lanes::simd_from(self, numbers)
    }
    #[inline(always)]
    fn points_in_lanes(self, [a, b, c, d]: [&[f64; 2]; LANES]) -> Points<S> {
        // Whole points are loaded and then shuffled. Lanes made of an array of coordinates would be written to memory one by one
        // and read back at once, for which a processor has to wait.
        let (a, b) = (self.load_array_ref_f64x2(a), self.load_array_ref_f64x2(b));
        let (c, d) = (self.load_array_ref_f64x2(c), self.load_array_ref_f64x2(d));
        let (ab, cd) = (a.combine(b), c.combine(d));
        [ab.unzip_low(cd), ab.unzip_high(cd)]
    }
    #[inline(always)]
    fn compiled<R>(self, function: impl FnOnce() -> R) -> R {
        self.vectorize(function)
    }
}

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
    const LANES: usize = LANES;
    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        self[lane]
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, number: f64) {
        self[lane] = number;
    }
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

/// Gathers the positions of vertices into lanes.
#[inline(always)]
pub(crate) fn points<W: Width>(
    width: W,
    positions: &[DVec2],
    vertices: [u32; LANES],
) -> [W::Numbers; 2] {
    let [a, b, c, d] = vertices;
    let (a, b) = (positions[a as usize].as_ref(), positions[b as usize].as_ref());
    width.points_in_lanes([a, b, positions[c as usize].as_ref(), positions[d as usize].as_ref()])
}

/// Gathers the numbers of vertices into lanes.
#[inline(always)]
pub(crate) fn numbers<W: Width>(width: W, numbers: &[f64], vertices: [u32; LANES]) -> W::Numbers {
    let [a, b, c, d] = vertices;
    let (a, b) = (numbers[a as usize], numbers[b as usize]);
    width.in_lanes([a, b, numbers[c as usize], numbers[d as usize]])
}

/// Gathers the target maps of vertices into lanes; identities if the mesh has no targets.
#[inline(always)]
pub(crate) fn vertex_maps<W: Width>(
    width: W,
    maps: Option<&[[f32; 3]]>,
    vertices: [u32; LANES],
) -> [W::Numbers; 3] {
    let Some(maps) = maps else {
        let (zero, one) = (width.splat(0.0), width.splat(1.0));
        return [one, zero, one];
    };
    let [a, b, c, d] = vertices;
    let (a, b) = (&maps[a as usize], &maps[b as usize]);
    let (c, d) = (&maps[c as usize], &maps[d as usize]);
    // A loop over lanes instead of `map` of arrays, which is not inlined here and would take a third of a sweep.
    let lane = |i: usize| {
        width.in_lanes([f64::from(a[i]), f64::from(b[i]), f64::from(c[i]), f64::from(d[i])])
    };
    [lane(0), lane(1), lane(2)]
}

#[cfg(test)]
thread_local! {
    /// How many kinds of vector instructions are left out, the newest first.
    static LEFT_OUT: std::cell::Cell<u32> = const { std::cell::Cell::new(0) };
}

/// Calls a function three times, on threads of its own: with the vector instructions of this processor, with those of older
/// processors, and without. Without optimization, runs in lanes take more stack than threads usually have.
#[cfg(test)]
pub(crate) fn with_each_width<R: Send>(of: impl Fn() -> R + Send + Sync) -> [R; 3] {
    [0, 1, 2].map(|left_out| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(2)
            .stack_size(1 << 26)
            .start_handler(move |_| LEFT_OUT.set(left_out))
            .build();
        pool.unwrap().install(&of)
    })
}
