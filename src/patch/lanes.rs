//! SIMD lanes: four numbers at once on a processor with vector instructions, and one number alone on others.
//!
//! Every operation rounds like the operation of `f64`, and none are fused, so results depend neither on the processor
//! nor on which numbers share a vector.

use fearless_simd::prelude::*;
use fearless_simd::{f64x4, mask64x4};
use glam::DVec2;

use crate::metric::Real;
use crate::patch::numbers::{self, Numbers};

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
