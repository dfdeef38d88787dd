//! Rounds of Newton steps around triangles beyond limits, on a mesh with its points as they are stored.

use std::borrow::Cow;
use std::collections::HashSet;

use glam::DVec2;

use crate::layout::Problem;
use crate::options::{Guard, Options, WorstBy};
use crate::parallel::paced;
use crate::run::{Plan, set_guards};
use crate::slide::{OnCurves, Sliding};
use crate::targets::Surface;
use crate::whole::altitude;
use crate::worst::{
    Badness, MoveConstraints, Penalties, TriangleSet, WorstShapes, around, rounds, sorted,
};

use super::prepared::Smoother;

/// Number of triangles that one task measures.
const CHUNK: usize = 1 << 12;
/// Largest number of visits in all rounds: a constant, and a multiple of the number of free vertices. On a regular mesh,
/// every triangle may be as bad as the worst. The limits keep the time of the rounds below that of the run.
const MAX_VISITS: [usize; 2] = [20_000, 4];

/// The limits of some rounds, and the penalties on triangles beyond them.
pub(super) trait Aim: Sync {
    /// Largest number of rounds.
    const ROUNDS: u32;
    /// Number of rings of vertices around the triangles beyond the limits that move too.
    const RINGS: u32;

    /// Returns the penalties of a round, counted from 0.
    fn penalties(&self, round: u32) -> Penalties;

    /// Returns whether the vertices around a corner take steps in the rounds.
    fn is_beyond(&self, corner: PlacedCorner<'_>) -> bool;

    /// Returns the triangles of the mesh on which penalties are larger from now on.
    fn heavy(&self, movable: &Movable<'_>, points: &[[f64; 2]]) -> Vec<[u32; 3]>;

    /// Returns the largest inverse mean ratio and the least altitude, in normalized units, of triangles around a vertex that
    /// moves.
    fn limits(&self) -> [f64; 2] {
        [f64::INFINITY, 0.0]
    }

    /// Returns whether a corner that is beyond the limits demands another round.
    fn demands_more(&self, corner: PlacedCorner<'_>) -> bool {
        self.is_beyond(corner)
    }
}

/// A corner of the mesh with its vertices at points on a surface.
#[derive(Clone, Copy)]
pub(super) struct PlacedCorner<'p> {
    surface: Surface,
    points: &'p [[f64; 2]],
    vertices: &'p [u32; 3],
    /// Whether the corner is of a quadrilateral, whose ideal angle is right.
    pub(super) is_right: bool,
}

impl PlacedCorner<'_> {
    pub(super) fn shapes(self) -> WorstShapes {
        WorstShapes::of(self.surface, self.points, self.vertices, self.is_right)
    }

    pub(super) fn least_cotangent(self) -> f64 {
        WorstShapes::least_cotangent(self.surface, self.points, self.vertices)
    }
}

/// A mesh on which rounds move the free vertices, and the vertices that slide.
pub(super) struct Movable<'s> {
    pub(super) smoother: &'s Smoother<'s>,
    pub(super) surface: Surface,
    /// Whether each vertex of the mesh may move: is free or slides.
    may_move: Cow<'s, [bool]>,
}

/// The state of a run that rounds change: normalized positions of the vertices of a problem, and the same positions as
/// points that are stored.
pub(super) struct Present<'r> {
    pub(super) problem: &'r Problem,
    pub(super) curves: Option<&'r mut OnCurves>,
    pub(super) positions: &'r [DVec2],
    pub(super) points: &'r mut [[f64; 2]],
}

impl<'s> Movable<'s> {
    pub(super) fn new(smoother: &'s Smoother<'_>) -> Self {
        let is_on_sphere = smoother.problem.is_projected();
        let surface = if is_on_sphere { Surface::Sphere } else { Surface::Plane };
        let mut may_move = Cow::Borrowed(smoother.topology.free());
        for v in smoother.sliding.as_deref().map(Sliding::vertices).unwrap_or_default() {
            may_move.to_mut()[smoother.problem.vertices()[v as usize] as usize] = true;
        }
        Self { smoother, surface, may_move }
    }

    pub(super) fn can_move(&self, triangle: &[u32; 3]) -> bool {
        triangle.iter().any(|&v| self.may_move[v as usize])
    }

    /// Returns a corner with the vertices at `points`; `None` if none of its vertices can move.
    pub(super) fn placed<'p>(
        &'p self,
        points: &'p [[f64; 2]],
        corner: u32,
    ) -> Option<PlacedCorner<'p>> {
        let corners = self.smoother.topology.corner_list();
        let vertices = &corners.all()[corner as usize];
        let is_right = !corners.is_triangle(corner);
        let surface = self.surface;
        self.can_move(vertices).then_some(PlacedCorner { surface, points, vertices, is_right })
    }

    /// Returns the indices of the corners that can move and satisfy `is_chosen` at `points`, ascending.
    pub(super) async fn chosen(
        &self,
        points: &[[f64; 2]],
        is_chosen: impl Fn(PlacedCorner<'_>) -> bool + Sync,
    ) -> Vec<u32> {
        let count = self.smoother.topology.corners().len();
        let is_one = |c: &u32| self.placed(points, *c).is_some_and(&is_chosen);
        let chosen = paced::map_ranges(count, CHUNK, |range| -> Vec<u32> {
            (range.start as u32..range.end as u32).filter(is_one).collect()
        });
        chosen.await.concat()
    }

    /// Does rounds of Newton steps by the penalties of `aim`. In each round, the free vertices around the triangles beyond
    /// the limits, and the vertices near them that slide, take steps. The rounds end if no triangle demands more, if
    /// `goes_on` returns false, or at the largest number of rounds or visits.
    pub(super) async fn descend<A: Aim>(
        &self,
        aim: &A,
        options: &Options,
        present: Present<'_>,
        mut goes_on: impl FnMut() -> bool,
    ) {
        let Present { problem, mut curves, positions, points } = present;
        let stored = self.smoother.storage(options);
        let mut plan = Plan::new(options);
        let step = plan.base_step(1.0);
        let shape = match options.guard {
            Guard::Worst => {
                let start = &self.smoother.problem;
                set_guards(&mut plan, options.guard, start, start.positions()).await;
                plan.base_step(1.0).shape_guard
            }
            Guard::ByMetric => f64::INFINITY,
        };
        let least_altitude = if options.keep_altitude { altitude::least_of(problem) } else { 0.0 };
        let [shape, least_altitude] = {
            let [most, least] = aim.limits();
            [shape.min(most), least_altitude.max(least)]
        };
        let mut heavy = TriangleSet::new();
        let topology = &self.smoother.topology;
        let corners = |t: u32| topology.corners()[t as usize];
        let number = problem.numbers(points.len());
        let mut positions = paced::copied(positions).await;
        let mut beyond = self.chosen(points, |corner| aim.is_beyond(corner)).await;
        let [least, share] = MAX_VISITS;
        let mut visits = least.max(share * problem.free_count());
        for round in 0..A::ROUNDS {
            let seeds = || beyond.iter().flat_map(|&t| corners(t)).map(|v| number[v as usize]);
            let regions = around(problem, seeds(), A::RINGS);
            let in_round = regions.iter().map(Vec::len).sum::<usize>() * rounds::VISITS as usize;
            if in_round > visits || !goes_on() {
                return;
            }
            visits -= in_round;
            let penalties = aim.penalties(round);
            let found = aim.heavy(self, points).into_iter();
            heavy.extend(found.map(|triangle| sorted(triangle.map(|v| number[v as usize]))));
            let rules = MoveConstraints {
                badness: Badness(WorstBy::Imr),
                step,
                shape,
                least_altitude,
                bounds: problem.radii(),
                heavy: Some(&heavy).filter(|heavy| !heavy.is_empty()),
            };
            let mut near = HashSet::new();
            if curves.is_some() {
                near.extend(seeds());
                near.extend(regions.iter().flatten().flat_map(|&v| problem.companions(v)));
            }
            let moves = rounds::round(problem, &rules, penalties, &positions, regions).await;
            for (v, to) in moves {
                positions[v as usize] = to;
                let at = problem.vertices()[v as usize];
                points[at as usize] = stored.rounded(at as usize, problem.point(to));
                beyond.extend(topology.corners_with(at));
            }
            let slid = curves.as_mut().map(|curves| {
                curves.visit_by(&penalties, problem, &mut positions, |v| near.contains(&v))
            });
            for (at, point) in slid.into_iter().flatten() {
                points[at as usize] = stored.rounded(at as usize, point);
                beyond.extend(topology.corners_with(at));
            }
            beyond.sort_unstable();
            beyond.dedup();
            let placed = |c: u32| self.placed(points, c);
            beyond.retain(|&c| placed(c).is_some_and(|corner| aim.is_beyond(corner)));
            let mut left = beyond.iter().filter_map(|&c| placed(c));
            if !left.any(|corner| aim.demands_more(corner)) {
                return;
            }
        }
    }
}
