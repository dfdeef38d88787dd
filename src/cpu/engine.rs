//! The f64 engine: the reference for tests, and what runs where there is no adapter.
//!
//! Same colors, same steps and same stopping as the GPU engine, on all cores.

use std::borrow::Cow;

use glam::{DVec2, Vec2};

use crate::cpu::objective::{Along, mean_excess, mean_excess_along};
use crate::cpu::{sweep, vcycle};
use crate::error::GpuError;
use crate::layout::Problem;
use crate::metric::Metric;
use crate::parallel::{for_each_chunk, map_parts};
use crate::run::multilevel::Hierarchy;
use crate::run::{Engine, History, Objectives, Plan, Proposal, Step};

/// Vertices that one task moves.
const CHUNK: usize = 1 << 12;

/// A mesh that is swept on the CPU, in double precision.
pub(crate) struct CpuEngine<'a> {
    problem: &'a Problem,
    base: Metric,
    tracked: Vec<Metric>,
    /// The step whose shape guard and exponent corrections go by.
    step: Step,
    positions: Vec<DVec2>,
    /// The best state; `None` if that is always the last.
    best: Option<Vec<DVec2>>,
    /// Room for a sweep to work in.
    moved: Vec<DVec2>,
    hierarchy: Option<Hierarchy>,
    gradient: Vec<Vec2>,
    /// The last correction.
    direction: Vec<Vec2>,
}

impl<'a> CpuEngine<'a> {
    /// The mesh at `positions`, normalized and in the problem's order.
    pub(crate) fn new(problem: &'a Problem, positions: Vec<DVec2>, plan: &Plan) -> Self {
        let best = (!plan.is_monotone()).then(|| positions.clone());
        Self {
            problem,
            base: plan.scheme.base(),
            tracked: plan.tracked(),
            step: plan.base_step(1.0),
            positions,
            best,
            moved: Vec::new(),
            hierarchy: None,
            gradient: Vec::new(),
            direction: Vec::new(),
        }
    }

    fn sweep_now(&mut self, step: &Step) {
        sweep::sweep(self.problem, &mut self.positions, &mut self.moved, step);
    }

    fn objectives_now(&self) -> Objectives {
        let mut values = Objectives::untracked();
        for &metric in &self.tracked {
            let excess = mean_excess(metric, self.problem, &self.positions);
            values.set(metric, metric.ideal_squared() + excess);
        }
        values
    }

    fn record(&mut self, history: &mut History) {
        if history.record(self.objectives_now())
            && let Some(best) = &mut self.best
        {
            best.copy_from_slice(&self.positions);
        }
    }

    fn try_length(&self, length: f64) -> Option<f64> {
        let Self { positions, direction, .. } = self;
        let along = Along { positions, direction, length };
        mean_excess_along(self.base, self.problem, &along, self.step.shape_guard)
    }

    /// The derivative of the mean excess along the correction.
    fn slope(&self) -> f64 {
        let parts = self.gradient.chunks(CHUNK).zip(self.direction.chunks(CHUNK));
        let dot = |_, (g, d): (&[Vec2], &[Vec2])| -> f64 {
            g.iter().zip(d).map(|(g, d)| g.as_dvec2().dot(d.as_dvec2())).sum()
        };
        // Added up in order, whatever the threads.
        map_parts(parts, dot).iter().sum::<f64>() / self.problem.triangles().len() as f64
    }
}

impl Engine for CpuEngine<'_> {
    async fn sweep(&mut self, step: &Step) -> Result<(), GpuError> {
        self.sweep_now(step);
        Ok(())
    }

    async fn objectives(&mut self) -> Result<Objectives, GpuError> {
        Ok(self.objectives_now())
    }

    async fn sweeps(&mut self, steps: &[Step], history: &mut History) -> Result<(), GpuError> {
        if history.is_empty() {
            self.record(history);
        }
        for step in steps {
            if history.stop().is_some() {
                break;
            }
            self.sweep_now(step);
            self.record(history);
        }
        Ok(())
    }

    async fn positions(&mut self) -> Result<Cow<'_, [DVec2]>, GpuError> {
        Ok(Cow::Borrowed(&self.positions))
    }

    async fn best_positions(&mut self) -> Result<Vec<DVec2>, GpuError> {
        Ok(self.best.as_ref().unwrap_or(&self.positions).clone())
    }

    fn take_hierarchy(&mut self) -> Option<Hierarchy> {
        self.hierarchy.take()
    }

    fn set_hierarchy(&mut self, hierarchy: Hierarchy) -> Result<(), GpuError> {
        self.hierarchy = Some(hierarchy);
        Ok(())
    }

    async fn propose(&mut self, step: &Step, length: f64) -> Result<Proposal, GpuError> {
        self.sweep_now(step);
        let Self { base, problem, positions, gradient, .. } = self;
        sweep::gradient(*base, problem, positions, self.step.sharpness, gradient);
        // Room for a direction is taken anew: that of the last goes first.
        self.direction = Vec::new();
        self.direction = match &self.hierarchy {
            Some(hierarchy) => vcycle::correction(hierarchy, problem, gradient),
            None => vec![Vec2::ZERO; gradient.len()],
        };
        let slope = self.slope();
        let here = mean_excess(self.base, self.problem, &self.positions);
        let there = if slope < 0.0 { self.try_length(length) } else { None };
        Ok(Proposal { here, slope, there })
    }

    async fn excess_along(&mut self, length: f64) -> Result<Option<f64>, GpuError> {
        Ok(self.try_length(length))
    }

    async fn move_along(&mut self, length: f64) -> Result<(), GpuError> {
        let Self { positions, direction, .. } = self;
        let free = direction.len();
        for_each_chunk(&mut positions[..free], CHUNK, |first, positions| {
            for (position, along) in positions.iter_mut().zip(&direction[first..]) {
                *position += along.as_dvec2() * length;
            }
        });
        Ok(())
    }
}
