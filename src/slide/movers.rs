//! The vertices that a Newton step moves: free vertices, followed by sliding vertices.

use crate::layout::{OPPOSITE, Problem};
use crate::run::multilevel::NONE;
use crate::run::truncated::aggregation::{Members, Pattern};
use crate::slide::on_curves::OnCurves;

/// The vertices that move. Free vertices have the numbers of the problem, and sliding ones follow.
pub(crate) struct Movers<'a> {
    problem: &'a Problem,
    /// Index in the problem of each sliding vertex.
    slides: Vec<u32>,
    /// Number of each vertex of the problem after the free ones, [`NONE`] for fixed vertices. Empty if none slides.
    number: Vec<u32>,
    /// Index in `neighbors` of the first neighbor of each sliding vertex, and at the end the length of `neighbors`.
    start: Vec<u32>,
    neighbors: Vec<u32>,
}

impl<'a> Movers<'a> {
    pub(crate) fn new(problem: &'a Problem, curves: Option<&OnCurves>) -> Self {
        let free = problem.free_count();
        let mut movers =
            Self { problem, slides: vec![], number: vec![], start: vec![0], neighbors: vec![] };
        for fan in curves.into_iter().flat_map(OnCurves::fans) {
            movers.slides.push(fan.own());
            let first = movers.neighbors.len();
            movers.neighbors.extend(fan.corners().iter().flat_map(|&[_, a, b]| [a, b]));
            movers.neighbors[first..].sort_unstable();
            let mut kept = first;
            for at in first..movers.neighbors.len() {
                if at == first || movers.neighbors[at] != movers.neighbors[kept - 1] {
                    movers.neighbors[kept] = movers.neighbors[at];
                    kept += 1;
                }
            }
            movers.neighbors.truncate(kept);
            movers.start.push(kept as u32);
        }
        if !movers.slides.is_empty() {
            movers.number = vec![NONE; problem.positions().len() - free];
            for (number, &vertex) in (free as u32..).zip(&movers.slides) {
                movers.number[vertex as usize - free] = number;
            }
        }
        movers
    }

    /// Returns the number of free and sliding vertices.
    pub(crate) fn count(&self) -> usize {
        self.problem.free_count() + self.slides.len()
    }

    pub(crate) fn sliding(&self) -> usize {
        self.slides.len()
    }

    /// Returns the index in the problem of a vertex that moves.
    pub(crate) fn vertex(&self, mover: u32) -> u32 {
        let slide = (mover as usize).checked_sub(self.problem.free_count());
        slide.map_or(mover, |slide| self.slides[slide])
    }

    /// Returns the number of a vertex of the problem, [`NONE`] for a fixed vertex.
    #[inline(always)]
    pub(crate) fn of(&self, vertex: u32) -> u32 {
        match (vertex as usize).checked_sub(self.problem.free_count()) {
            None => vertex,
            Some(at) => self.number.get(at).copied().unwrap_or(NONE),
        }
    }

    /// Returns the index of a vertex of the problem among the sliding vertices, [`NONE`] for other vertices.
    pub(crate) fn slide(&self, vertex: u32) -> u32 {
        let free = self.problem.free_count() as u32;
        match self.of(vertex) {
            NONE => NONE,
            mover => mover.checked_sub(free).unwrap_or(NONE),
        }
    }

    /// Returns the vertices that share an element with a vertex that moves, as indices in the problem. The highest bit of an
    /// index is to be ignored.
    fn marked_neighbors(&self, mover: usize) -> &[u32] {
        match mover.checked_sub(self.problem.free_count()) {
            None => self.problem.ring_of(mover as u32),
            Some(at) => &self.neighbors[self.start[at] as usize..self.start[at + 1] as usize],
        }
    }

    /// Returns the vertices that share an element with a vertex that moves, as indices in the problem.
    pub(crate) fn neighbors(&self, mover: usize) -> impl Iterator<Item = u32> + '_ {
        self.marked_neighbors(mover).iter().map(|&v| v & !OPPOSITE)
    }

    /// Joins the vertices that move to aggregates of neighbors. Returns the aggregates, and the pattern of their matrix.
    pub(crate) async fn joined(&self) -> (Members, Pattern) {
        let degree = |mover: usize| self.marked_neighbors(mover).len();
        let near = |mover: usize| self.neighbors(mover).map(|v| self.of(v));
        let members = Members::new(self.count(), degree, near).await;
        let pattern = members.pattern(|mover| near(mover as usize)).await;
        (members, pattern)
    }
}
