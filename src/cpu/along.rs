//! The positions of vertices along a correction: straight, or within discs.

use glam::DVec2;

use crate::layout::Problem;
use crate::parallel::paced;
use crate::patch::lanes::{LANES, Width, points};
use crate::patch::{Circle, is_kept, keeps_altitude};

/// Positions before and after a move of the free vertices.
pub(crate) struct Along<'a> {
    pub(crate) positions: &'a [DVec2],
    /// Position of each free vertex after the move.
    pub(crate) moved: &'a [DVec2],
}

impl Along<'_> {
    /// Returns the positions of vertices, one in each lane, before and after the move.
    #[inline(always)]
    pub(super) fn points<W: Width>(
        &self,
        width: W,
        vertices: [u32; LANES],
    ) -> ([W::Numbers; 2], [W::Numbers; 2]) {
        let [a, b, c, d] = vertices;
        let places = [self.place(a), self.place(b), self.place(c), self.place(d)];
        (points(width, self.positions, vertices), width.points_in_lanes(places))
    }

    /// Returns whether the move keeps a corner acceptable; see [`is_kept`] and [`keeps_altitude`]. Compiled once for all
    /// metrics.
    #[inline(never)]
    pub(super) fn keeps(
        &self,
        problem: &Problem,
        is_right: bool,
        triangle: &[u32; 3],
        guard: f64,
    ) -> bool {
        let position = |v: u32| self.positions[v as usize];
        let now = problem.corner_of(is_right, triangle, |v| self.to(v));
        let keeps_altitude = || {
            let at = |position: DVec2| problem.coordinates().at(position);
            let [before, now] =
                [triangle.map(|v| at(position(v))), triangle.map(|v| at(self.to(v)))];
            keeps_altitude(problem.least_altitude(), before, now)
        };
        is_kept(&problem.corner_of(is_right, triangle, position), &now, guard)
            && (problem.least_altitude() <= 0.0 || keeps_altitude())
    }

    /// Returns the position of a vertex after the move.
    #[inline(always)]
    pub(super) fn to(&self, vertex: u32) -> DVec2 {
        DVec2::from_array(*self.place(vertex))
    }

    #[inline(always)]
    fn place(&self, vertex: u32) -> &[f64; 2] {
        let vertex = vertex as usize;
        match self.moved.get(vertex) {
            Some(moved) => moved.as_ref(),
            None => self.positions[vertex].as_ref(),
        }
    }

    /// Returns the positions of all vertices after the move.
    pub(super) async fn all_moved(&self) -> Vec<DVec2> {
        paced::collect(self.positions.len(), |v| self.to(v as u32)).await
    }
}

/// Returns for each free vertex whether the move breaks a corner with it, as defined at
/// [`mean_excess_along`](super::objective::mean_excess_along), with the shape guard `guard`.
pub(crate) async fn broken(problem: &Problem, along: &Along<'_>, guard: f64) -> Vec<bool> {
    paced::collect(along.moved.len(), |v| {
        let breaks =
            |(corner, is_right): ([u32; 3], bool)| !along.keeps(problem, is_right, &corner, guard);
        problem.corners_around(v as u32).any(breaks)
    })
    .await
}

/// Returns the disc of a free vertex. `None` without discs.
pub(super) fn disc(problem: &Problem, vertex: usize) -> Option<Circle> {
    let &radius = problem.radii()?.get(vertex)?;
    Some(Circle { center: problem.coordinates().at(problem.positions()[vertex]), radius })
}

/// Returns `to` as the position of a free vertex, or the nearest position within the disc of the vertex.
pub(super) fn nearest(problem: &Problem, vertex: usize, to: DVec2) -> DVec2 {
    disc(problem, vertex).map_or(to, |disc| disc.nearest_position(problem.coordinates(), to))
}
