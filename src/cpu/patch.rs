//! Four free vertices with their one-rings, one in each lane, and sums over their patches.

use fearless_simd::prelude::*;
use glam::DVec2;

use crate::cpu::lanes::{LANES, Lanes, Mask, Points};
use crate::layout::Problem;
use crate::metric::{Corner, Dual, Formulas, Own, Real, Smoothing, TargetMap};

/// The one-rings of four free vertices with the same number of neighbors. If `MAPPED`, triangles are transformed by
/// target maps.
#[derive(Clone, Copy)]
pub(crate) struct Patches<'a, S: Simd, const MAPPED: bool> {
    /// Positions of the neighbors, counter-clockwise, with the first repeated at the end.
    ring: &'a [Points<S>],
    /// The target map of each triangle, if the mesh has targets.
    maps: &'a [TargetMap<Lanes<S>>],
    /// The inverse of the target map of each vertex itself, if the mesh has targets.
    inverse_map: Option<TargetMap<Lanes<S>>>,
    /// Mean area of the mesh's triangles, after their target maps are applied.
    mean_area: f64,
}

/// Memory for [`Patches`].
pub(crate) struct Room<S: Simd> {
    ring: Vec<Points<S>>,
    maps: Vec<TargetMap<Lanes<S>>>,
}

impl<S: Simd> Room<S> {
    pub(crate) fn new() -> Self {
        Self { ring: Vec::with_capacity(16), maps: Vec::new() }
    }
}

impl<'a, S: Simd, const MAPPED: bool> Patches<'a, S, MAPPED> {
    /// Reads the one-rings of `vertices`, and their target maps, into `room`.
    #[inline(always)]
    pub(crate) fn gather(
        simd: S,
        problem: &Problem,
        positions: &[DVec2],
        vertices: [u32; LANES],
        room: &'a mut Room<S>,
    ) -> Self {
        let Room { ring, maps } = room;
        let [a, b, c, d] = vertices;
        let a = problem.ring_of(a);
        let degree = a.len();
        let b = &problem.ring_of(b)[..degree];
        let c = &problem.ring_of(c)[..degree];
        let d = &problem.ring_of(d)[..degree];
        ring.clear();
        for i in 0..degree {
            ring.push(points(simd, positions, [a[i], b[i], c[i], d[i]]));
        }
        ring.push(ring[0]);
        let mut inverse_map = None;
        if MAPPED {
            let targets = problem.targets();
            let own = of_corners(simd, targets, vertices);
            let mut before = of_corners(simd, targets, [a[0], b[0], c[0], d[0]]);
            let first = before;
            maps.clear();
            for i in 1..degree {
                let next = of_corners(simd, targets, [a[i], b[i], c[i], d[i]]);
                maps.push(TargetMap::mean([own, before, next]));
                before = next;
            }
            maps.push(TargetMap::mean([own, before, first]));
            inverse_map = Some(TargetMap(own).inverse());
        }
        Self { ring, maps, inverse_map, mean_area: problem.mean_area() }
    }

    /// The number of neighbors of each vertex.
    pub(crate) fn degree(&self) -> usize {
        self.ring.len() - 1
    }

    /// The inverse of the target map of each vertex, if the mesh has targets.
    #[inline(always)]
    pub(crate) fn inverse_map(&self) -> &Option<TargetMap<Lanes<S>>> {
        &self.inverse_map
    }

    /// The squared length of one edge at each vertex: that to its first neighbor.
    #[inline(always)]
    pub(crate) fn squared_edge(&self, at: Points<S>) -> Lanes<S> {
        let (x, y) = (self.ring[0][0] - at[0], self.ring[0][1] - at[1]);
        x * x + y * y
    }

    /// The triangle between the neighbors `i` and `i` + 1 with the vertices at `at`, transformed by its target map.
    #[inline(always)]
    pub(crate) fn corner(&self, i: usize, at: Points<S>) -> Corner<Lanes<S>> {
        let (p, q) = (self.ring[i], self.ring[i + 1]);
        let (a, b) = ([p[0] - at[0], p[1] - at[1]], [q[0] - at[0], q[1] - at[1]]);
        let corner = Corner { a, b, mean_area: self.mean_area };
        if MAPPED { self.maps[i].show(&corner) } else { corner }
    }

    /// The objectives of the patches with their derivatives.
    #[inline(always)]
    pub(crate) fn derivatives(
        &self,
        formulas: impl Formulas,
        at: Points<S>,
        smoothing: Smoothing,
    ) -> Dual<Lanes<S>> {
        let zero = at[0].constant(0.0);
        let mut sum = Dual { value: zero, gradient: [zero; 2], hessian: [zero; 3] };
        for i in 0..self.degree() {
            let corner = self.corner(i, at);
            let shown = formulas.expansion(&corner, Own, smoothing);
            sum = sum + if MAPPED { self.maps[i].pull_back(shown) } else { shown };
        }
        sum
    }

    /// The largest inverse mean ratio of each patch, infinite if a triangle is inverted or flat.
    #[inline(always)]
    pub(crate) fn worst_shape(&self, formulas: impl Formulas, at: Points<S>) -> Lanes<S> {
        let mut worst = at[0].constant(0.0);
        for i in 0..self.degree() {
            let corner = self.corner(i, at);
            let (numerator, area) = formulas.inverse_mean_ratio(&corner);
            let positive = area.simd_gt(0.0);
            let ratio = numerator / area;
            worst = Real::max(worst, positive.select(ratio, worst.constant(f64::INFINITY)));
        }
        worst
    }

    /// The objectives of the patches, and which patches are feasible. A patch is feasible if no triangle is inverted or
    /// flat, nor, if it is `guarded`, has an inverse mean ratio above `limit`.
    #[inline(always)]
    pub(crate) fn objective(
        &self,
        formulas: impl Formulas,
        at: Points<S>,
        smoothing: Smoothing,
        limit: Lanes<S>,
        guarded: bool,
    ) -> (Lanes<S>, Mask<S>) {
        let mut sum = at[0].constant(0.0);
        let mut feasible = Mask::splat(sum.simd, true);
        for i in 0..self.degree() {
            let corner = self.corner(i, at);
            feasible &= corner.doubled_area().simd_gt(0.0);
            if guarded {
                // Both sides are multiplied by the area, as a division costs as much as the rest of the guard.
                let (numerator, area) = formulas.inverse_mean_ratio(&corner);
                feasible &= numerator.simd_le(limit * area);
            }
            sum += formulas.model(&corner, smoothing);
        }
        (sum, feasible)
    }
}

/// The target maps of some vertices, one in each lane; the identity in a mesh without targets.
#[inline(always)]
pub(crate) fn of_corners<S: Simd>(
    simd: S,
    targets: Option<&[[f32; 3]]>,
    vertices: [u32; LANES],
) -> [Lanes<S>; 3] {
    let Some(targets) = targets else {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        return [one, zero, one];
    };
    let [a, b, c, d] = vertices;
    let (a, b) = (&targets[a as usize], &targets[b as usize]);
    let (c, d) = (&targets[c as usize], &targets[d as usize]);
    // A loop over lanes instead of `map` of arrays, which is not inlined here and would take a third of a sweep.
    let lane = |i: usize| {
        let numbers = [f64::from(a[i]), f64::from(b[i]), f64::from(c[i]), f64::from(d[i])];
        Lanes::simd_from(simd, numbers)
    };
    [lane(0), lane(1), lane(2)]
}

/// The positions of some vertices, one in each lane.
#[inline(always)]
pub(crate) fn points<S: Simd>(simd: S, positions: &[DVec2], vertices: [u32; LANES]) -> Points<S> {
    let [a, b, c, d] = vertices;
    let (a, b) = (positions[a as usize], positions[b as usize]);
    let (c, d) = (positions[c as usize], positions[d as usize]);
    [Lanes::simd_from(simd, [a.x, b.x, c.x, d.x]), Lanes::simd_from(simd, [a.y, b.y, c.y, d.y])]
}
