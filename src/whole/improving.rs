//! The worst triangles improved after the sweeps of a run, and what came of it.

use glam::DVec2;

use crate::cpu::mean_excess;
use crate::layout::Problem;
use crate::outcome::Improved;
use crate::run::{NOISE, Options, Stop, WorstBy};
use crate::whole::altitude;
use crate::worst::{Badness, Rules, improve, worst_movable};

/// How much rounding may add to the worst inverse mean ratio, as a share.
const ROUNDING: f64 = 1e-9;

/// A stage that improved the worst triangles. What it did is judged by the coordinates as they are written.
pub(crate) struct Improving {
    badness: Badness,
    /// Number of vertices that moved.
    vertices: usize,
    /// The largest badness before the stage.
    worst: f64,
    /// The objective by the base metric before and after the stage.
    pub(crate) f: [f64; 2],
}

impl Improving {
    /// Improves the worst triangles of a mesh with its vertices at `positions`, where a run has stopped, if its options ask for that. No
    /// vertex goes farther than `bounds` from where the run began.
    pub(crate) fn after(
        stop: Stop,
        options: &Options,
        problem: &Problem,
        bounds: Option<&[f64]>,
        positions: &mut [DVec2],
    ) -> Option<Self> {
        let badness = Badness(options.improve_worst?);
        if matches!(stop, Stop::Cancelled | Stop::NotFinite) {
            return None;
        }
        let base = options.scheme.base();
        let f = |positions: &[DVec2]| base.ideal_squared() + mean_excess(base, problem, positions);
        let before = f(positions);
        let (worst_before, _) = worst_movable(problem, badness, positions);
        let (worst_shape, _) = worst_movable(problem, Badness(WorstBy::Imr), positions);
        let rules = Rules {
            badness,
            step: options.plan().base_step(1.0),
            shape: worst_shape.sqrt() * (1.0 + ROUNDING),
            floor: if options.keep_altitude { altitude::least_of(problem) } else { 0.0 },
            bounds,
        };
        let vertices = improve(problem, &rules, positions);
        Some(Self { badness, vertices, worst: worst_before, f: [before, f(positions)] })
    }

    /// Whether the worst triangle is better than in the mesh before the run.
    pub(crate) fn is_better(&self, problem: &Problem, positions: &[DVec2]) -> bool {
        let worst = |positions| worst_movable(problem, self.badness, positions).0;
        self.vertices > 0 && worst(positions) < worst(problem.positions()) * (1.0 - NOISE)
    }

    /// What is to be told of the stage, with the vertices at `positions` as they are written, where the objective is f. Nothing came of it if
    /// that is the mesh before the run.
    pub(crate) fn outcome(
        &self,
        problem: &Problem,
        (positions, f): (&[DVec2], f64),
        is_written: bool,
    ) -> Improved {
        let (now, stuck) = worst_movable(problem, self.badness, positions);
        let [now, before] = [now, self.worst].map(|worst| self.badness.meaning(worst, problem));
        let by = self.badness.0;
        match is_written {
            true => {
                let Self { vertices, f: [start, _], .. } = *self;
                Improved { by, vertices, worst: [before, now], stuck, f: [start, f] }
            }
            false => Improved { by, vertices: 0, worst: [now; 2], stuck, f: [f; 2] },
        }
    }
}
