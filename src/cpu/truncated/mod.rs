//! Newton steps of all free vertices at once, solved approximately by conjugate gradients.
//!
//! The Hessian is never assembled: each triangle stores nine numbers. The preconditioner is additive: the inverse of the
//! diagonal blocks at the vertices, and the coarser [`levels`], both from a positive semidefinite part of the Hessian.

mod blocks;
mod couplings;
mod derivatives;
mod levels;
mod matrix;
mod product;
mod scalar;
mod slides;
mod solve;
mod terms;
#[cfg(test)]
mod tests;

use glam::DVec2;

use crate::cpu::along::Along;
use crate::cpu::objective::{mean_excess, mean_excess_along};
use crate::layout::Problem;
use crate::metric::Metric;
use crate::run::truncated::{NewtonStep, StepRequest, StepSearch, could_gain};
use crate::run::{GoesOn, MIN_SCALE, SweepParams};
use crate::slide::{OfPatch, OnCurves, Params, Tangents};
use solve::{Solved, Solver};

/// A mesh prepared for Newton steps, in single or double precision. Strongly stretched triangles need double precision: in
/// single precision, lattices stretched 1:1000 left 2.7 times the reported gain, and those of 1:10,000 did not end.
pub(super) enum Truncated {
    Single(Box<Solver<f32>>),
    Double(Box<Solver<f64>>),
}

/// Calls a method on the solver inside a [`Truncated`].
macro_rules! on {
    ($self:ident, $solver:ident => $call:expr) => {
        match $self {
            Truncated::Single($solver) => $call,
            Truncated::Double($solver) => $call,
        }
    };
}

impl Truncated {
    /// Prepares a mesh, with the vertices that slide. A mesh with local maps is strongly stretched, and gets double precision.
    pub(super) async fn new(problem: &Problem, curves: Option<&OnCurves>) -> Self {
        match problem.has_local_maps() {
            true => Self::Double(Box::new(Solver::new(problem, curves).await)),
            false => Self::Single(Box::new(Solver::new(problem, curves).await)),
        }
    }

    /// Takes a Newton step from `positions`. Sliding vertices move along `curves`.
    pub(super) async fn step(
        &mut self,
        sweep: &SweepParams,
        problem: &Problem,
        positions: &mut [DVec2],
        mut curves: Option<&mut OnCurves>,
        request: &StepRequest,
        goes_on: &mut GoesOn<'_>,
    ) -> NewtonStep {
        let metric: Metric = sweep.metric;
        let count = problem.judged_count() as f64;
        let swept = mean_excess(metric, problem, positions).await;
        let mut tangents = tangents(curves.as_deref_mut(), sweep, problem, positions);
        let is_exact = tangents.restrict(request.is_exact);
        let objective = (swept + metric.ideal_squared()).max(MIN_SCALE);
        let request = &StepRequest { objective, ..*request };
        let solved = self.solve(metric, problem, positions, &tangents, request, goes_on).await;
        let Solved { model_gain, descent, bound, least_ritz, is_curved_down, iterations } = solved;
        let search = StepSearch::new(swept, descent / count);
        let on = curves.as_deref().map(|curves| (curves, &tangents));
        let mut moved = Vec::new();
        let search = self.search(search, sweep, problem, positions, on, &mut moved);
        let (search, accepted) = search.await;
        let (length, excess) = search.best();
        if let Some(curves) = &mut curves {
            curves.record_step(length);
        }
        if length > 0.0 {
            positions[..moved.len()].copy_from_slice(&moved);
            if let (Some(curves), Some(params)) = (&mut curves, accepted) {
                curves.set_params(&params);
            }
        }
        NewtonStep {
            swept,
            excess,
            model_gain: model_gain / count,
            bound: bound / count,
            least_ritz,
            length,
            is_curved_down,
            is_broken: search.is_broken(),
            is_exact,
            slides: !tangents.vertices.is_empty(),
            held: tangents.vertices.iter().filter(|vertex| vertex.is_held).count(),
            iterations,
        }
    }

    /// Returns how far a Newton step from `positions` could lower the mean excess. `None` if the model has negative curvature.
    pub(super) async fn remaining(
        &mut self,
        sweep: &SweepParams,
        problem: &Problem,
        positions: &[DVec2],
        mut curves: Option<OnCurves>,
        request: &StepRequest,
        goes_on: &mut GoesOn<'_>,
    ) -> Option<f64> {
        let mut tangents = tangents(curves.as_mut(), sweep, problem, positions);
        tangents.restrict(request.is_exact);
        let count = problem.judged_count() as f64;
        let metric = sweep.metric;
        let solved = self.solve(metric, problem, positions, &tangents, request, goes_on).await;
        let Solved { model_gain, bound, is_curved_down, .. } = solved;
        could_gain(model_gain / count, bound / count, is_curved_down)
    }

    /// Solves for a step from `positions`, where f is the objective of the request.
    async fn solve(
        &mut self,
        metric: Metric,
        problem: &Problem,
        positions: &[DVec2],
        tangents: &Tangents,
        request: &StepRequest,
        goes_on: &mut GoesOn<'_>,
    ) -> Solved {
        on!(self, solver => solver.linearize(metric, problem, positions, tangents).await);
        let movers = problem.free_count() + tangents.vertices.len();
        let all_move = movers == problem.positions().len();
        let request = &request.for_mesh(all_move);
        let scale = request.objective * problem.judged_count() as f64;
        let least_gain = request.least_gain * scale;
        on!(self, solver => solver.solve(request, least_gain, goes_on).await)
    }

    /// Tries lengths along the solution, and writes the positions at the last of them to `moved`. Returns the search, and the
    /// parameters of sliding vertices at the accepted length.
    async fn search(
        &self,
        mut search: StepSearch,
        sweep: &SweepParams,
        problem: &Problem,
        positions: &[DVec2],
        curves: Option<(&OnCurves, &Tangents)>,
        moved: &mut Vec<DVec2>,
    ) -> (StepSearch, Option<Params>) {
        let free = problem.free_count();
        moved.extend_from_slice(if curves.is_some() { positions } else { &positions[..free] });
        let (mut params, mut accepted) = (None, None);
        while let Some(length) = search.next() {
            on!(self, solver => solver.write_moved(positions, length, &mut moved[..free]).await);
            if let Some((curves, tangents)) = curves {
                let way = |slide: usize| length * on!(self, solver => solver.way(slide));
                let to = curves.along(tangents, way);
                for (vertex, at) in curves.placed(problem, &to) {
                    moved[vertex as usize] = at;
                }
                params = Some(to);
            }
            let along = Along { positions, moved };
            search.tried(length, mean_excess_along(sweep, problem, &along).await);
            if search.best().0 == length {
                accepted = params.take();
            }
        }
        (search, accepted)
    }
}

/// Returns the sliding vertices, if any, as unknowns of a step by the metric of `sweep` from `positions`.
fn tangents(
    curves: Option<&mut OnCurves>,
    sweep: &SweepParams,
    problem: &Problem,
    positions: &[DVec2],
) -> Tangents {
    let Some(curves) = curves else { return Tangents::default() };
    curves.tangents(problem, |fan| {
        let patch = fan.patch(problem, positions, 0.0);
        sweep.of(&patch).expansion(positions[fan.own() as usize].to_array()).gradient.into()
    })
}
