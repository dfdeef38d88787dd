//! The state of a run on the host, between sweeps on the engine.

use glam::DVec2;

use crate::cpu::mean_excess;
use crate::layout::Problem;
use crate::parallel::map_parts;
use crate::run::{Objectives, Plan};

/// The state that stages change between sweeps. Positions are normalized, and of all vertices.
pub(crate) struct Host<'r> {
    /// The layout, with the present targets.
    pub(crate) problem: Problem,
    pub(crate) plan: &'r Plan,
    /// The positions before the sweeps, which keep all bounds.
    pub(crate) before: Vec<DVec2>,
    /// f by the base metric before the sweeps.
    pub(crate) f_before: f64,
    /// The present positions: those after the sweeps, until a stage changes them.
    pub(crate) positions: Vec<DVec2>,
    /// For each free vertex, whether sweeps are not to move it.
    pub(crate) held: Vec<bool>,
    /// Whether the targets have changed since the last sweep.
    pub(crate) has_new_targets: bool,
}

impl<'r> Host<'r> {
    /// Makes the state before the first sweep. No vertex is held.
    pub(crate) fn new(problem: Problem, plan: &'r Plan, positions: &[DVec2]) -> Self {
        let held = vec![false; problem.free_count()];
        let f_before = f(&problem, plan, positions);
        let (before, positions) = (positions.to_vec(), positions.to_vec());
        Self { problem, plan, before, f_before, positions, held, has_new_targets: false }
    }

    /// Begins a period at the present positions, where f by the base metric is `f`.
    pub(crate) fn begin_period(&mut self, f: f64) {
        self.before.clone_from(&self.positions);
        self.f_before = f;
    }

    /// Returns f by the base metric at some positions.
    pub(crate) fn f(&self, positions: &[DVec2]) -> f64 {
        f(&self.problem, self.plan, positions)
    }

    /// Returns the guard of the run.
    pub(crate) fn guard(&self) -> f64 {
        self.plan.base_step(1.0).shape_guard
    }

    /// Whether a move from `from` leaves no triangle inverted or flat, and none with an inverse mean ratio that is both
    /// worse than before and above the guard.
    pub(crate) fn is_sound(&self, from: &[DVec2], to: &[DVec2]) -> bool {
        let (problem, guard) = (&self.problem, self.guard());
        let ratio = |positions: &[DVec2], t: &[u32; 3]| {
            problem.corner(t, |v| positions[v as usize]).inverse_mean_ratio()
        };
        let is_sound = |t: &[u32; 3]| {
            let now = ratio(to, t);
            now.is_finite() && (now <= guard || now <= ratio(from, t))
        };
        let parts =
            map_parts(problem.triangles().chunks(4096), |_, part| part.iter().all(is_sound));
        parts.into_iter().all(|is_sound| is_sound)
    }
}

/// Evaluates f by the base metric of a plan.
fn f(problem: &Problem, plan: &Plan, positions: &[DVec2]) -> f64 {
    let base = plan.scheme.base();
    base.ideal_squared() + mean_excess(base, problem, positions)
}

/// Evaluates the objectives that a plan tracks.
pub(crate) fn objectives(problem: &Problem, plan: &Plan, positions: &[DVec2]) -> Objectives {
    let mut objectives = Objectives::untracked();
    for metric in plan.tracked() {
        let excess = mean_excess(metric, problem, positions);
        objectives.set(metric, metric.ideal_squared() + excess);
    }
    objectives
}
