//! A curve on which vertices slide, alone or with partners on a second curve.

use glam::DVec2;

use crate::layout::Problem;
use crate::slide::newton::{Reach, Window};
use crate::slide::side::BoundaryCurve;

/// A curve on which vertices slide. If the vertices have partners, the second side is the curve of the partners.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    pub(super) sides: Vec<BoundaryCurve>,
    /// Whether partners have equal positions, as on the sides of a crack.
    pub(super) is_coincident: bool,
}

impl Track {
    /// Returns the parameters of the given positions, common to both sides.
    pub(super) fn start(&self) -> &[f64] {
        self.sides[0].curve.params()
    }

    /// Returns the number of vertices on each side.
    pub(super) fn count(&self) -> usize {
        self.sides[0].vertices.len()
    }

    /// Returns whether the curve ends at its start.
    #[cfg(feature = "gpu")]
    pub(super) fn is_closed(&self) -> bool {
        self.slides(0)
    }

    pub(super) fn slides(&self, k: usize) -> bool {
        self.sides[0].slides(k)
    }

    /// Moves the vertices of index `k` on all sides to a parameter, if they slide.
    pub(super) fn follow(&self, problem: &Problem, k: usize, param: f64, positions: &mut [DVec2]) {
        for (vertex, at) in self.placed(problem, k, param) {
            positions[vertex as usize] = at;
        }
    }

    /// Returns the vertices of index `k` on all sides, if they slide, with their positions at a parameter.
    pub(super) fn placed(
        &self,
        problem: &Problem,
        k: usize,
        param: f64,
    ) -> impl Iterator<Item = (u32, DVec2)> {
        let sliding =
            self.sides.iter().filter_map(move |side| Some((side, side.fans[k].as_ref()?)));
        sliding.map(move |(side, fan)| (fan.own(), side.at(problem, param, k).point))
    }

    /// Returns `known` for the vertex before (`to` = -1) or after (1) vertex `k`. On a closed curve, parameters
    /// continue past the first vertex: by one period for each turn.
    pub(super) fn neighbor(
        &self,
        k: usize,
        to: isize,
        known: impl Fn(usize) -> Option<f64>,
    ) -> Option<f64> {
        let (at, count) = (k as isize + to, self.count() as isize);
        let turns = at.div_euclid(count);
        let param = known(at.rem_euclid(count) as usize)?;
        Some(param + turns as f64 * self.sides[0].curve.period())
    }

    /// Returns the bound on the distance of vertex `k` from its given position.
    pub(super) fn reach(&self, reach: &[f64], k: usize) -> Reach {
        Reach { vertex: k, start: self.start()[k], most: reach[k] }
    }

    /// Returns the parameters of vertex `k` and of its two neighbors.
    pub(super) fn window(&self, params: &[f64], k: usize) -> Window {
        let neighbor = |to| self.neighbor(k, to, |i| Some(params[i])).unwrap_or(params[k]);
        Window { low: neighbor(-1), at: params[k], high: neighbor(1) }
    }
}
