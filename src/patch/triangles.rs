//! Four triangles, one in each lane.

use fearless_simd::prelude::*;

use crate::patch::lanes::{LANES, Lanes, Mask, Points, Width};
use crate::targets::Surface;
use crate::topology::predicates::{ROUNDING, UNDERFLOW};

/// Limits of the longest coordinate of edges between which no product of edges overflows or loses bits.
const USUAL: [f64; 2] = [1e-60, 1e60];

/// Four triangles whose exact areas are surely positive, in coordinates as stored. A formula gives the same bits for four
/// triangles as for each of them alone.
#[derive(Clone, Copy)]
pub(crate) struct FourTriangles<S: Simd> {
    /// Edges from the first to the second corner.
    pub(crate) a: Points<S>,
    /// Edges from the first to the third corner.
    pub(crate) b: Points<S>,
    /// Edges from the second to the third corner.
    pub(crate) c: Points<S>,
    /// Twice the area, as [`orientation`](crate::topology::predicates::orientation) returns it, times both lengths.
    pub(crate) doubled_area: Lanes<S>,
}

impl<S: Simd> FourTriangles<S> {
    /// Returns four triangles with vertices at `points`, as seen on `surface`. `None` if an area is so small that only exact arithmetic tells its sign,
    /// if a triangle is inverted, or if the size of a triangle is beyond [`USUAL`] limits.
    #[inline(always)]
    pub(crate) fn of(
        simd: S,
        surface: Surface,
        points: &[[f64; 2]],
        four: &[[u32; 3]; LANES],
    ) -> Option<Self> {
        let [t, u, v, w] = four;
        let p = corners(simd, points, [t[0], u[0], v[0], w[0]]);
        let q = corners(simd, points, [t[1], u[1], v[1], w[1]]);
        let r = corners(simd, points, [t[2], u[2], v[2], w[2]]);
        let (mut a, mut b, mut c) = (edge(p, q), edge(p, r), edge(q, r));
        let (left, right) = ((p[0] - r[0]) * (q[1] - r[1]), (p[1] - r[1]) * (q[0] - r[0]));
        let mut doubled_area = left - right;
        let least = (left.abs() + right.abs()) * ROUNDING + UNDERFLOW;
        let is_sure = doubled_area.simd_gt(least);
        if surface != Surface::Plane {
            let lengths = lengths(simd, surface, points, four);
            (a, b, c) = (scaled(a, lengths), scaled(b, lengths), scaled(c, lengths));
            doubled_area = doubled_area * lengths[0] * lengths[1];
        }
        let size = longer(longer(longest(a), longest(b)), longest(c));
        let is_usual = size.simd_gt(USUAL[0]) & size.simd_lt(USUAL[1]);
        let of_edges = a[0] * b[1] - a[1] * b[0];
        let is_positive: Mask<S> = is_sure & of_edges.simd_gt(0.0);
        (is_usual & is_positive).all_true().then_some(Self { a, b, c, doubled_area })
    }
}

#[inline(always)]
fn corners<S: Simd>(simd: S, points: &[[f64; 2]], [a, b, c, d]: [u32; LANES]) -> Points<S> {
    let (a, b) = (&points[a as usize], &points[b as usize]);
    simd.points_in_lanes([a, b, &points[c as usize], &points[d as usize]])
}

/// Returns the lengths on the surface of a unit of each coordinate.
#[inline(always)]
fn lengths<S: Simd>(
    simd: S,
    surface: Surface,
    points: &[[f64; 2]],
    [t, u, v, w]: &[[u32; 3]; LANES],
) -> Points<S> {
    let of = |t: &[u32; 3]| surface.lengths_in(points, t);
    simd.points_in_lanes([&of(t), &of(u), &of(v), &of(w)])
}

#[inline(always)]
fn scaled<S: Simd>(edge: Points<S>, lengths: Points<S>) -> Points<S> {
    [edge[0] * lengths[0], edge[1] * lengths[1]]
}

#[inline(always)]
fn edge<S: Simd>(from: Points<S>, to: Points<S>) -> Points<S> {
    [to[0] - from[0], to[1] - from[1]]
}

#[inline(always)]
fn longest<S: Simd>(edge: Points<S>) -> Lanes<S> {
    longer(edge[0].abs(), edge[1].abs())
}

#[inline(always)]
fn longer<S: Simd>(x: Lanes<S>, y: Lanes<S>) -> Lanes<S> {
    SimdFloat::max(x, y)
}

/// Returns the scalar products of edges.
#[inline(always)]
pub(crate) fn dot<S: Simd>(u: Points<S>, v: Points<S>) -> Lanes<S> {
    u[0] * v[0] + u[1] * v[1]
}
