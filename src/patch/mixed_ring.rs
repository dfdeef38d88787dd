//! The one-rings of free vertices of quadrilaterals, or of quadrilaterals and triangles, one vertex in each lane.

use std::ops::Mul;

use glam::DVec2;

use crate::layout::{OPPOSITE, Problem};
use crate::metric::{Corner, Dual, Given, Ideal, TargetMap};
use crate::patch::corners::Corners;
use crate::patch::direction::{Direction, newton_direction};
use crate::patch::lanes::{LANES, Width, points, vertex_maps};
use crate::patch::numbers::Numbers;
use crate::patch::ring::{LanePatch, mapped_direction, squared_distance};
use crate::patch::role::{AroundVertex, Role};

/// One-rings of free vertices whose elements are of equal kinds in equal order.
#[derive(Clone, Copy)]
pub(crate) struct MixedRings<'a, T: Numbers> {
    /// Positions of the vertices around each visited vertex, counter-clockwise: neighbors, and opposite vertices of
    /// quadrilaterals.
    ring: &'a [[T; 2]],
    corners: &'a [RingCorner],
    /// The quadrilaterals of the visited vertex, with vertices as indices in the ring.
    quadrilaterals: &'a [AroundVertex],
    /// Target map of each corner, then of the corner of each quadrilateral opposite the visited vertex. Empty without targets
    /// and local maps.
    maps: &'a [TargetMap<T>],
    /// Inverse of the target map or local map of each visited vertex. `None` without maps.
    inverse_map: Option<TargetMap<T>>,
    total_weight: f64,
    ideal: Ideal,
}

/// A corner that depends on the visited vertex.
#[derive(Clone, Copy)]
struct RingCorner {
    role: Role,
    /// Its other two vertices, counter-clockwise, as indices in the ring.
    others: [u32; 2],
}

/// Memory for [`MixedRings`], reused by one visit after another.
pub(crate) struct MixedScratch<T: Numbers> {
    ring: Vec<[T; 2]>,
    /// The mark of each vertex of the ring that `corners` lists the corners of. Successive visits mostly have equal marks.
    marks: Vec<u32>,
    corners: Vec<RingCorner>,
    quadrilaterals: Vec<AroundVertex>,
    total_weight: f64,
    maps: Vec<TargetMap<T>>,
}

impl<T: Numbers> MixedScratch<T> {
    pub(crate) fn new() -> Self {
        Self {
            ring: Vec::with_capacity(16),
            marks: Vec::new(),
            corners: Vec::new(),
            quadrilaterals: Vec::new(),
            total_weight: 0.0,
            maps: Vec::new(),
        }
    }
}

impl<'a, T: Numbers> MixedRings<'a, T> {
    /// Reads the one-rings of `vertices`, and their target maps, into `scratch`.
    #[inline(always)]
    pub(crate) fn gather<W: Width<Numbers = T>>(
        width: W,
        problem: &Problem,
        positions: &[DVec2],
        vertices: [u32; LANES],
        scratch: &'a mut MixedScratch<T>,
    ) -> Self {
        let MixedScratch { ring, marks, corners, quadrilaterals, total_weight, maps } = scratch;
        let [a, b, c, d] = vertices;
        let a = problem.ring_of(a);
        let length = a.len();
        let b = &problem.ring_of(b)[..length];
        let c = &problem.ring_of(c)[..length];
        let d = &problem.ring_of(d)[..length];
        let at =
            |i: usize| [a[i] & !OPPOSITE, b[i] & !OPPOSITE, c[i] & !OPPOSITE, d[i] & !OPPOSITE];
        ring.clear();
        for i in 0..length {
            ring.push(points(width, positions, at(i)));
        }
        let is_listed = || marks.iter().zip(a).all(|(&mark, &k)| mark == k & OPPOSITE);
        if marks.len() != length || !is_listed() {
            marks.clear();
            marks.extend(a.iter().map(|k| k & OPPOSITE));
            corners.clear();
            list_corners(a, corners);
            quadrilaterals.clear();
            let roles = corners.iter().map(|corner| (corner.role, corner.others));
            quadrilaterals.extend(AroundVertex::all(roles));
            *total_weight = corners.iter().map(|corner| corner.role.weighted(1.0)).sum();
        }
        maps.clear();
        let mut inverse_map = None;
        if problem.maps().is_some() {
            let of = |vertices| vertex_maps(width, problem.targets(), vertices);
            let own = of(vertices);
            maps.extend(corners.iter().map(|corner| {
                let [p, q] = corner.others.map(|i| of(at(i as usize)));
                TargetMap::mean([own, p, q])
            }));
            let opposites = quadrilaterals.iter().map(|of| of.opposite);
            maps.extend(
                opposites.map(|places| TargetMap::mean(places.map(|i| of(at(i as usize))))),
            );
            inverse_map = Some(TargetMap(vertex_maps(width, problem.maps(), vertices)).inverse());
        }
        let (total_weight, ideal) = (*total_weight, problem.ideal());
        Self { ring, corners, quadrilaterals, maps, inverse_map, total_weight, ideal }
    }
}

impl<T: Numbers> MixedRings<'_, T> {
    /// Returns a corner with the given vertices, transformed by the map of an index if there are maps.
    #[inline(always)]
    fn corner_of(&self, is_right: bool, [p, q, r]: [[T; 2]; 3], map: usize) -> Corner<T> {
        // Differences come first: a general form that is linear in the vertex would cancel for small elements.
        let (a, b) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
        let mut corner = Corner { a, b, ideal: self.ideal };
        if is_right {
            corner = corner.of_right_angle();
        }
        match self.maps.get(map) {
            Some(map) => map.transform(&corner),
            None => corner,
        }
    }
}

/// Lists the corners around a vertex, given its list in [`Problem::ring`].
fn list_corners(ring: &[u32], corners: &mut Vec<RingCorner>) {
    let is_opposite = |i: usize| ring[i % ring.len()] & OPPOSITE != 0;
    let place = |i: usize| (i % ring.len()) as u32;
    for i in (0..ring.len()).filter(|&i| !is_opposite(i)) {
        let mut add = |role, a, b| corners.push(RingCorner { role, others: [place(a), place(b)] });
        if is_opposite(i + 1) {
            let [next, opposite, last] = [i, i + 1, i + 2];
            add(Role::Own, next, last);
            add(Role::Next, next, opposite);
            add(Role::Last, last, opposite);
        } else {
            add(Role::Triangle, i, i + 1);
        }
    }
}

impl<T: Numbers> LanePatch<T> for MixedRings<'_, T> {
    #[inline(always)]
    fn inverse_map(&self) -> &Option<TargetMap<T>> {
        &self.inverse_map
    }

    #[inline(always)]
    fn squared_edge(&self, at: [T; 2]) -> T {
        squared_distance(self.ring[0], at)
    }

    #[inline(always)]
    fn vertices(&self, i: usize, at: [T; 2]) -> [[T; 2]; 3] {
        let RingCorner { role, others: [p, q] } = self.corners[i];
        role.vertices(at, [self.ring[p as usize], self.ring[q as usize]])
    }
}

impl<T: Numbers> Corners<T> for MixedRings<'_, T> {
    type Slopes = Given;

    #[inline(always)]
    fn count(&self) -> usize {
        self.corners.len()
    }

    #[inline(always)]
    fn corner(&self, i: usize, at: [T; 2]) -> Corner<T> {
        self.corner_of(self.corners[i].role.is_right(), self.vertices(i, at), i)
    }

    #[inline(always)]
    fn quadrilaterals(&self) -> usize {
        self.quadrilaterals.len()
    }

    #[inline(always)]
    fn quadrilateral(&self, k: usize) -> (usize, Corner<T>) {
        let AroundVertex { first, opposite } = self.quadrilaterals[k];
        let vertices = opposite.map(|i| self.ring[i as usize]);
        (first, self.corner_of(true, vertices, self.corners.len() + k))
    }

    #[inline(always)]
    fn slopes(&self, i: usize) -> Given {
        self.corners[i].role.slopes()
    }

    #[inline(always)]
    fn weighted<V: Mul<f64, Output = V>>(&self, i: usize, term: V) -> V {
        self.corners[i].role.weighted(term)
    }

    #[inline(always)]
    fn total_weight(&self) -> f64 {
        self.total_weight
    }

    #[inline(always)]
    fn pull_back(&self, i: usize, transformed: Dual<T>) -> Dual<T> {
        match self.maps.get(i) {
            Some(map) => map.pull_back(transformed),
            None => transformed,
        }
    }

    #[inline(always)]
    fn direction(&self, sum: &Dual<T>, eigenvalue_floor: f64) -> Direction<T> {
        match &self.inverse_map {
            Some(inverse) => mapped_direction(inverse, sum, eigenvalue_floor),
            None => newton_direction(sum, eigenvalue_floor),
        }
    }
}
