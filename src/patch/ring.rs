//! The one-rings of free vertices that are visited at once, one in each lane.

use glam::DVec2;

use crate::layout::Problem;
use crate::metric::{Corner, Dual, Ideal, Own, TargetMap};
use crate::patch::corners::Corners;
use crate::patch::direction::{Direction, newton_direction};
use crate::patch::lanes::{LANES, Width, points, vertex_maps};
use crate::patch::numbers::Numbers;

/// The patches of visited vertices, one in each lane.
pub(crate) trait LanePatch<T: Numbers>: Corners<T> {
    /// Returns the inverse of the target map or local map of each visited vertex. `None` if the vertices have no maps.
    fn inverse_map(&self) -> &Option<TargetMap<T>>;

    /// Returns the squared length of the edge from each vertex to its first neighbor.
    fn squared_edge(&self, at: [T; 2]) -> T;

    /// Returns the positions of the vertices of a corner, counter-clockwise, with the visited vertices at `at`.
    fn vertices(&self, i: usize, at: [T; 2]) -> [[T; 2]; 3];
}

/// One-rings of free vertices of equal degree, without quadrilaterals. If `MAPPED`, the vertices have target maps or local maps.
#[derive(Clone, Copy)]
pub(crate) struct Rings<'a, T: Numbers, const MAPPED: bool> {
    /// Positions of the neighbors, counter-clockwise, with the first repeated at the end.
    ring: &'a [[T; 2]],
    /// Target map of each triangle, the identity without targets; unused if not `MAPPED`.
    maps: &'a [TargetMap<T>],
    /// Inverse of the target map or local map of each visited vertex; `None` if not `MAPPED`.
    inverse_map: Option<TargetMap<T>>,
    ideal: Ideal,
}

/// Memory for [`Rings`], reused by one visit after another.
pub(crate) struct Scratch<T: Numbers> {
    ring: Vec<[T; 2]>,
    maps: Vec<TargetMap<T>>,
}

impl<T: Numbers> Scratch<T> {
    pub(crate) fn new() -> Self {
        Self { ring: Vec::with_capacity(16), maps: Vec::new() }
    }
}

impl<'a, T: Numbers, const MAPPED: bool> Rings<'a, T, MAPPED> {
    /// Reads the one-rings of `vertices`, and their target maps, into `scratch`.
    #[inline(always)]
    pub(crate) fn gather<W: Width<Numbers = T>>(
        width: W,
        problem: &Problem,
        positions: &[DVec2],
        vertices: [u32; LANES],
        scratch: &'a mut Scratch<T>,
    ) -> Self {
        let Scratch { ring, maps } = scratch;
        let [a, b, c, d] = vertices;
        let a = problem.ring_of(a);
        let degree = a.len();
        let b = &problem.ring_of(b)[..degree];
        let c = &problem.ring_of(c)[..degree];
        let d = &problem.ring_of(d)[..degree];
        if ring.len() <= degree {
            ring.resize(degree + 1, [width.splat(0.0); 2]);
        }
        let ring = &mut ring[..=degree];
        for i in 0..degree {
            ring[i] = points(width, positions, [a[i], b[i], c[i], d[i]]);
        }
        ring[degree] = ring[0];
        let mut inverse_map = None;
        if MAPPED {
            let targets = problem.targets();
            let own = vertex_maps(width, targets, vertices);
            let mut before = vertex_maps(width, targets, [a[0], b[0], c[0], d[0]]);
            let first = before;
            maps.clear();
            for i in 1..degree {
                let next = vertex_maps(width, targets, [a[i], b[i], c[i], d[i]]);
                maps.push(TargetMap::mean([own, before, next]));
                before = next;
            }
            maps.push(TargetMap::mean([own, before, first]));
            let own = vertex_maps(width, problem.maps(), vertices);
            inverse_map = Some(TargetMap(own).inverse());
        }
        Self { ring, maps, inverse_map, ideal: problem.ideal() }
    }
}

impl<T: Numbers, const MAPPED: bool> LanePatch<T> for Rings<'_, T, MAPPED> {
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
        [at, self.ring[i], self.ring[i + 1]]
    }
}

/// Returns the squared distance of points.
#[inline(always)]
pub(super) fn squared_distance<T: Numbers>(p: [T; 2], q: [T; 2]) -> T {
    let (x, y) = (p[0] - q[0], p[1] - q[1]);
    x * x + y * y
}

impl<T: Numbers, const MAPPED: bool> Corners<T> for Rings<'_, T, MAPPED> {
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
    fn corner(&self, i: usize, at: [T; 2]) -> Corner<T> {
        let (p, q) = (self.ring[i], self.ring[i + 1]);
        let (a, b) = ([p[0] - at[0], p[1] - at[1]], [q[0] - at[0], q[1] - at[1]]);
        let corner = Corner { a, b, ideal: self.ideal };
        if MAPPED { self.maps[i].transform(&corner) } else { corner }
    }

    #[inline(always)]
    fn pull_back(&self, i: usize, transformed: Dual<T>) -> Dual<T> {
        if MAPPED { self.maps[i].pull_back(transformed) } else { transformed }
    }

    #[inline(always)]
    fn direction(&self, sum: &Dual<T>, eigenvalue_floor: f64) -> Direction<T> {
        match &self.inverse_map {
            Some(inverse) if MAPPED => mapped_direction(inverse, sum, eigenvalue_floor),
            _ => newton_direction(sum, eigenvalue_floor),
        }
    }
}

/// Returns the Newton direction in the coordinates of maps, given their inverses. The floor of eigenvalues is meant for nearly
/// ideal elements, and elements are nearly ideal in these coordinates.
#[inline(always)]
pub(super) fn mapped_direction<T: Numbers>(
    inverse: &TargetMap<T>,
    sum: &Dual<T>,
    eigenvalue_floor: f64,
) -> Direction<T> {
    let mapped = newton_direction(&inverse.pull_back(*sum), eigenvalue_floor);
    Direction { vector: inverse.apply(mapped.vector), ..mapped }
}
