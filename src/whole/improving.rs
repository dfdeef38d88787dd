//! Improves the worst triangles after the sweeps of a run, and evaluates the gain.

use glam::DVec2;

use crate::cpu::mean_excess;
use crate::layout::Problem;
use crate::options::{Options, WorstBy};
use crate::outcome::Improved;
use crate::run::{NOISE, Observer, Phase, Plan, Progress, Stop};
use crate::whole::altitude;
use crate::whole::live::RunEnd;
use crate::worst::{Badness, MoveConstraints, improve, stuck, worst_movable};

/// Share by which rounding may raise the worst inverse mean ratio.
const ROUNDING: f64 = 1e-9;

/// The result of the stage that improves the worst triangles, evaluated at the coordinates as they are written.
pub(crate) struct Improvement {
    badness: Badness,
    /// Number of vertices that the stage moved.
    vertices: usize,
    /// Largest badness of a movable triangle before the stage.
    worst: f64,
    /// Objective by the base metric at the start and at the end of the stage.
    pub(crate) f: [f64; 2],
}

impl Improvement {
    /// Improves the worst triangles of a mesh after a run. `None` if [`Options::improve_worst`] is `None`, or if the
    /// run was canceled or failed. `bounds` limit the distance of each free vertex from the start of the run. If the
    /// observer ends the stage, the run counts as canceled.
    pub(crate) fn after(
        ended: &mut RunEnd,
        options: &Options,
        problem: &Problem,
        bounds: Option<&[f64]>,
        observe: &mut dyn Observer,
    ) -> Option<Self> {
        let badness = Badness(options.improve_worst?);
        if matches!(ended.stop, Stop::Canceled | Stop::NotFinite) {
            return None;
        }
        let base = options.scheme.base();
        let f = |positions: &[DVec2]| base.ideal_squared() + mean_excess(base, problem, positions);
        let sweep = ended.history.len() as u32 - 1;
        let RunEnd { positions, stop, .. } = ended;
        let before = f(positions);
        let worst_before = worst_movable(problem, badness, positions);
        let worst_shape = worst_movable(problem, Badness(WorstBy::Imr), positions);
        let rules = MoveConstraints {
            badness,
            step: Plan::new(options).base_step(1.0),
            shape: worst_shape.sqrt() * (1.0 + ROUNDING),
            floor: if options.keep_altitude { altitude::least_of(problem) } else { 0.0 },
            bounds,
        };
        let goes_on = |positions: &[DVec2]| {
            let progress = Progress { phase: Phase::Improving, sweep, f: f(positions) };
            let is_left = observe(&progress).is_break();
            if is_left {
                *stop = Stop::Canceled;
            }
            !is_left
        };
        let vertices = improve(problem, &rules, positions, goes_on);
        Some(Self { badness, vertices, worst: worst_before, f: [before, f(positions)] })
    }

    /// Returns whether the worst triangle is better than in the mesh before the run.
    pub(crate) fn is_better(&self, problem: &Problem, positions: &[DVec2]) -> bool {
        let worst = |positions| worst_movable(problem, self.badness, positions);
        self.vertices > 0 && worst(positions) < worst(problem.positions()) * (1.0 - NOISE)
    }

    /// Returns the outcome of the stage, with the vertices at `positions` as they are written, and `f` the objective
    /// there. If `is_written` is false, `positions` are those before the run, and the stage has changed nothing.
    /// `slides` are the sliding vertices as indices in the problem, in ascending order.
    pub(crate) fn outcome(
        &self,
        problem: &Problem,
        positions: &[DVec2],
        f: f64,
        slides: &[u32],
        is_written: bool,
    ) -> Improved {
        let now = worst_movable(problem, self.badness, positions);
        let stuck = stuck(problem, self.badness, positions, slides);
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
