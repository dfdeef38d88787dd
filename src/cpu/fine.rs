//! The mesh itself in a multilevel run on the CPU.

use glam::{DVec2, Vec2};
use rayon::prelude::*;

use super::newton::{Patch, Step, inverse_mean_ratio, shape_guard};
use super::{mean_excess, sweep_once, vcycle};
use crate::engine::Objectives;
use crate::gpu::GpuError;
use crate::metric::{Corner, Metric, specialize};
use crate::multilevel::{FineLevel, Hierarchy, Proposal};
use crate::plan::Plan;
use crate::problem::Problem;

/// Positions in double precision, and where the last correction leads.
pub(crate) struct CpuFine<'a> {
    problem: &'a Problem,
    metric: Metric,
    tracked: Vec<Metric>,
    step: Step,
    positions: Vec<DVec2>,
    hierarchy: Option<Hierarchy>,
    direction: Vec<Vec2>,
    /// The positions last tried.
    trial: Vec<DVec2>,
}

impl<'a> CpuFine<'a> {
    /// The mesh at `positions`, normalized and in the problem's order.
    pub(crate) fn new(problem: &'a Problem, positions: Vec<DVec2>, plan: &Plan) -> Self {
        let step = Step {
            omega: 1.0,
            inner: plan.inner,
            sharpness: plan.sharpness.last,
            derivatives: plan.derivatives,
        };
        let (metric, tracked) = (plan.scheme.base(), plan.tracked());
        let trial = positions.clone();
        let direction = Vec::new();
        Self { problem, metric, tracked, step, positions, hierarchy: None, direction, trial }
    }

    /// The gradient of Σ q² at each free vertex.
    fn gradient(&self) -> Vec<DVec2> {
        let (problem, positions) = (self.problem, &self.positions);
        let start = problem.ring_start();
        let sharpness = self.step.sharpness;
        specialize!(self.metric, METRIC => {
            let of = |v: usize| -> DVec2 {
                let ring = &problem.ring()[start[v] as usize..start[v + 1] as usize];
                let patch = Patch { ring, positions, mean_area: problem.mean_area() };
                let corners = patch.corners(positions[v]);
                corners.map(|c| DVec2::from(METRIC.derivatives(&c, sharpness).gradient)).sum()
            };
            (0..problem.free_count()).into_par_iter().with_min_len(256).map(of).collect()
        })
    }

    fn try_length(&mut self, length: f64) -> Option<f64> {
        let moved = self.trial.par_iter_mut().with_min_len(4096);
        let from = self.positions.par_iter().zip(&self.direction);
        moved.zip(from).for_each(|(to, (&at, d))| *to = at + d.as_dvec2() * length);
        let (positions, trial) = (&self.positions, &self.trial);
        let guard = shape_guard(self.metric);
        let holds = |t: &[u32; 3]| {
            let there = triangle(trial, t);
            there.doubled_area() > 0.0
                && (guard.is_infinite()
                    || inverse_mean_ratio(&there)
                        <= guard.max(inverse_mean_ratio(&triangle(positions, t))))
        };
        let feasible = self.problem.triangles().par_iter().with_min_len(4096).all(holds);
        feasible.then(|| mean_excess(self.metric, self.problem, trial))
    }
}

/// A triangle for the shape guard, which no mean area matters to.
fn triangle(positions: &[DVec2], t: &[u32; 3]) -> Corner<f64> {
    let [p, q, r] = t.map(|v| positions[v as usize]);
    Corner { a: (q - p).to_array(), b: (r - p).to_array(), mean_area: 1.0 }
}

impl FineLevel for CpuFine<'_> {
    async fn objectives(&mut self) -> Result<Objectives, GpuError> {
        let mut values = Objectives::untracked();
        for &metric in &self.tracked {
            let excess = mean_excess(metric, self.problem, &self.positions);
            values.set(metric, metric.ideal_squared() + excess);
        }
        Ok(values)
    }

    async fn sweep(&mut self, omega: f64) -> Result<(), GpuError> {
        let step = Step { omega, ..self.step };
        sweep_once(self.metric, self.problem, &mut self.positions, &step);
        Ok(())
    }

    async fn positions(&mut self) -> Result<Vec<DVec2>, GpuError> {
        Ok(self.positions.clone())
    }

    fn set_hierarchy(&mut self, hierarchy: Hierarchy) -> Result<(), GpuError> {
        self.hierarchy = Some(hierarchy);
        Ok(())
    }

    async fn propose(&mut self, omega: f64, length: f64) -> Result<Proposal, GpuError> {
        self.sweep(omega).await?;
        let gradient = self.gradient();
        let coarse: Vec<Vec2> = gradient.iter().map(|g| g.as_vec2()).collect();
        self.direction = match &self.hierarchy {
            Some(hierarchy) => vcycle::correction(hierarchy, self.problem, &coarse),
            None => vec![Vec2::ZERO; coarse.len()],
        };
        let along = gradient.iter().zip(&self.direction).map(|(g, d)| g.dot(d.as_dvec2()));
        let slope = along.sum::<f64>() / self.problem.triangles().len() as f64;
        let here = mean_excess(self.metric, self.problem, &self.positions);
        let there = if slope < 0.0 { self.try_length(length) } else { None };
        Ok(Proposal { here, slope, there })
    }

    async fn objective_along(&mut self, length: f64) -> Result<Option<f64>, GpuError> {
        Ok(self.try_length(length))
    }

    async fn take(&mut self, length: f64) -> Result<(), GpuError> {
        for (to, d) in self.positions.iter_mut().zip(&self.direction) {
            *to += d.as_dvec2() * length;
        }
        Ok(())
    }
}
