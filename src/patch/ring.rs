//! The one-rings of four free vertices, one in each lane.

use fearless_simd::prelude::*;
use glam::DVec2;

use crate::layout::Problem;
use crate::metric::{Corner, Dual, Ideal, Own, TargetMap};
use crate::patch::corners::Corners;
use crate::patch::direction::{Direction, newton_direction};
use crate::patch::lanes::{LANES, Lanes, Points, points, vertex_maps};

/// The patches of four visited vertices, one in each lane.
pub(crate) trait LanePatch<S: Simd>: Corners<Lanes<S>> {
    /// Returns the inverse of the target map or local map of each visited vertex. `None` if the vertices have no maps.
    fn inverse_map(&self) -> &Option<TargetMap<Lanes<S>>>;

    /// Returns the squared length of the edge from each vertex to its first neighbor.
    fn squared_edge(&self, at: Points<S>) -> Lanes<S>;

    /// Returns the positions of the vertices of a corner, counter-clockwise, with the visited vertices at `at`.
    fn vertices(&self, i: usize, at: Points<S>) -> [Points<S>; 3];
}

/// One-rings of four free vertices of equal degree, without quadrilaterals. If `MAPPED`, the vertices have target maps or local maps.
#[derive(Clone, Copy)]
pub(crate) struct Rings<'a, S: Simd, const MAPPED: bool> {
    /// Positions of the neighbors, counter-clockwise, with the first repeated at the end.
    ring: &'a [Points<S>],
    /// Target map of each triangle, the identity without targets; unused if not `MAPPED`.
    maps: &'a [TargetMap<Lanes<S>>],
    /// Inverse of the target map or local map of each visited vertex; `None` if not `MAPPED`.
    inverse_map: Option<TargetMap<Lanes<S>>>,
    ideal: Ideal,
}

/// Memory for [`Rings`], reused by one visit after another.
pub(crate) struct Scratch<S: Simd> {
    ring: Vec<Points<S>>,
    maps: Vec<TargetMap<Lanes<S>>>,
}

impl<S: Simd> Scratch<S> {
    pub(crate) fn new() -> Self {
        Self { ring: Vec::with_capacity(16), maps: Vec::new() }
    }
}

impl<'a, S: Simd, const MAPPED: bool> Rings<'a, S, MAPPED> {
    /// Reads the one-rings of `vertices`, and their target maps, into `scratch`.
    #[inline(always)]
    pub(crate) fn gather(
        simd: S,
        problem: &Problem,
        positions: &[DVec2],
        vertices: [u32; LANES],
        scratch: &'a mut Scratch<S>,
    ) -> Self {
        let Scratch { ring, maps } = scratch;
        let [a, b, c, d] = vertices;
        let a = problem.ring_of(a);
        let degree = a.len();
        let b = &problem.ring_of(b)[..degree];
        let c = &problem.ring_of(c)[..degree];
        let d = &problem.ring_of(d)[..degree];
        if ring.len() <= degree {
            ring.resize(degree + 1, [Lanes::splat(simd, 0.0); 2]);
        }
        let ring = &mut ring[..=degree];
        for i in 0..degree {
            ring[i] = points(simd, positions, [a[i], b[i], c[i], d[i]]);
        }
        ring[degree] = ring[0];
        let mut inverse_map = None;
        if MAPPED {
            let targets = problem.targets();
            let own = vertex_maps(simd, targets, vertices);
            let mut before = vertex_maps(simd, targets, [a[0], b[0], c[0], d[0]]);
            let first = before;
            maps.clear();
            for i in 1..degree {
                let next = vertex_maps(simd, targets, [a[i], b[i], c[i], d[i]]);
                maps.push(TargetMap::mean([own, before, next]));
                before = next;
            }
            maps.push(TargetMap::mean([own, before, first]));
            let own = vertex_maps(simd, problem.maps(), vertices);
            inverse_map = Some(TargetMap(own).inverse());
        }
        Self { ring, maps, inverse_map, ideal: problem.ideal() }
    }
}

impl<S: Simd, const MAPPED: bool> LanePatch<S> for Rings<'_, S, MAPPED> {
    #[inline(always)]
    fn inverse_map(&self) -> &Option<TargetMap<Lanes<S>>> {
        &self.inverse_map
    }

    #[inline(always)]
    fn squared_edge(&self, at: Points<S>) -> Lanes<S> {
        squared_distance(self.ring[0], at)
    }

    #[inline(always)]
    fn vertices(&self, i: usize, at: Points<S>) -> [Points<S>; 3] {
        [at, self.ring[i], self.ring[i + 1]]
    }
}

/// Returns the squared distance of points.
#[inline(always)]
pub(super) fn squared_distance<S: Simd>(p: Points<S>, q: Points<S>) -> Lanes<S> {
    let (x, y) = (p[0] - q[0], p[1] - q[1]);
    x * x + y * y
}

impl<S: Simd, const MAPPED: bool> Corners<Lanes<S>> for Rings<'_, S, MAPPED> {
    type Slopes = Own;

    #[inline(always)]
    fn count(&self) -> usize {
        self.ring.len() - 1
    }

    #[inline(always)]
    fn slopes(&self, _: usize) -> Own {
        Own
    }

    /// Returns the triangle between the neighbors `i` and `i` + 1.
    #[inline(always)]
    fn corner(&self, i: usize, at: Points<S>) -> Corner<Lanes<S>> {
        let (p, q) = (self.ring[i], self.ring[i + 1]);
        let (a, b) = ([p[0] - at[0], p[1] - at[1]], [q[0] - at[0], q[1] - at[1]]);
        let corner = Corner { a, b, ideal: self.ideal };
        if MAPPED { self.maps[i].transform(&corner) } else { corner }
    }

    #[inline(always)]
    fn pull_back(&self, i: usize, transformed: Dual<Lanes<S>>) -> Dual<Lanes<S>> {
        if MAPPED { self.maps[i].pull_back(transformed) } else { transformed }
    }

    #[inline(always)]
    fn direction(&self, sum: &Dual<Lanes<S>>, eigenvalue_floor: f64) -> Direction<Lanes<S>> {
        match &self.inverse_map {
            Some(inverse) if MAPPED => mapped_direction(inverse, sum, eigenvalue_floor),
            _ => newton_direction(sum, eigenvalue_floor),
        }
    }
}

/// Returns the Newton direction in the coordinates of maps, given their inverses. The floor of eigenvalues is meant for nearly
/// ideal elements, and elements are nearly ideal in these coordinates.
#[inline(always)]
pub(super) fn mapped_direction<S: Simd>(
    inverse: &TargetMap<Lanes<S>>,
    sum: &Dual<Lanes<S>>,
    eigenvalue_floor: f64,
) -> Direction<Lanes<S>> {
    let mapped = newton_direction(&inverse.pull_back(*sum), eigenvalue_floor);
    Direction { vector: inverse.apply(mapped.vector), ..mapped }
}
