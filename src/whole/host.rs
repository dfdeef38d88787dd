//! The state of a run on the host, between sweeps on the engine.

use glam::DVec2;

use crate::cpu::mean_excess;
use crate::layout::Problem;
use crate::parallel::map_parts;
use crate::patch::{Circle, keeps_altitude};
use crate::run::{Objectives, Plan};

/// The state that the stage of a target field changes between sweeps. Positions are normalized and include fixed vertices.
pub(crate) struct Host<'r> {
    /// Layout of the mesh, with the present targets.
    pub(crate) problem: Problem,
    pub(crate) plan: &'r Plan,
    /// Positions before the sweeps of the period, which keep all bounds.
    pub(crate) before: Vec<DVec2>,
    /// f by the base metric at `before`.
    pub(crate) f_before: f64,
    /// Present positions: those at the end of the sweeps, until a stage moves vertices.
    pub(crate) positions: Vec<DVec2>,
    /// Whether a stage has changed targets since the last sweep.
    pub(crate) has_new_targets: bool,
}

impl<'r> Host<'r> {
    /// Creates the state before the first sweep.
    pub(crate) async fn new(problem: Problem, plan: &'r Plan, positions: &[DVec2]) -> Self {
        let f_before = f(&problem, plan, positions).await;
        let (before, positions) = (positions.to_vec(), positions.to_vec());
        Self { problem, plan, before, f_before, positions, has_new_targets: false }
    }

    /// Begins a period at the present positions. `f` is the objective by the base metric there.
    pub(crate) fn begin_period(&mut self, f: f64) {
        self.before.clone_from(&self.positions);
        self.f_before = f;
    }

    /// Returns f by the base metric at the given positions.
    pub(crate) async fn f(&self, positions: &[DVec2]) -> f64 {
        f(&self.problem, self.plan, positions).await
    }

    /// Returns the shape guard of sweeps by the base metric.
    pub(crate) fn guard(&self) -> f64 {
        self.plan.base_step(1.0).shape_guard
    }

    /// Returns whether a move from `from` to `to` is sound: no triangle may become inverted or flat, and none may have
    /// an inverse mean ratio both above the guard and worse than before. The bounds of the problem must hold too.
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
        parts.into_iter().all(|is_sound| is_sound) && is_within_bounds(problem, from, to)
    }
}

/// Returns whether a move from `from` to `to` keeps the bounds of a problem.
fn is_within_bounds(problem: &Problem, from: &[DVec2], to: &[DVec2]) -> bool {
    let (coordinates, floor) = (problem.coordinates(), problem.floor());
    let radii = problem.radii().unwrap_or_default().iter().zip(problem.positions()).zip(to);
    let corners = |t: &[u32; 3], at: &[DVec2]| t.map(|v| coordinates.at(at[v as usize]));
    radii.into_iter().all(|((&radius, &center), &at)| {
        Circle { center: coordinates.at(center), radius }.contains(coordinates.at(at))
    }) && (floor <= 0.0
        || problem
            .triangles()
            .iter()
            .all(|t| keeps_altitude(floor, corners(t, from), corners(t, to))))
}

/// Returns f by the base metric of a plan.
async fn f(problem: &Problem, plan: &Plan, positions: &[DVec2]) -> f64 {
    let base = plan.scheme.base();
    base.ideal_squared() + mean_excess(base, problem, positions).await
}

/// Returns the objectives that a plan tracks.
pub(crate) async fn objectives(problem: &Problem, plan: &Plan, positions: &[DVec2]) -> Objectives {
    let mut objectives = Objectives::empty();
    for metric in plan.tracked() {
        let excess = mean_excess(metric, problem, positions).await;
        objectives.set(metric, metric.ideal_squared() + excess);
    }
    objectives
}
