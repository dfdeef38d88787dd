//! The mesh itself in a multilevel run on the CPU.

use glam::{DVec2, Vec2};
use rayon::prelude::*;
use std::borrow::Cow;

use crate::cpu::newton::Step;
use crate::cpu::objective::{Along, mean_excess, mean_excess_along};
use crate::cpu::{sweep, vcycle};
use crate::error::GpuError;
use crate::layout::Problem;
use crate::metric::Metric;
use crate::run::Objectives;
use crate::run::multilevel::{FineLevel, Hierarchy, Proposal};
use crate::run::{Derivatives, Plan};

/// Vertices that one task moves.
const CHUNK: usize = 1 << 12;

/// Positions in double precision, and where the last correction leads.
pub(crate) struct CpuFine<'a> {
    problem: &'a Problem,
    metric: Metric,
    tracked: Vec<Metric>,
    step: Step,
    positions: Vec<DVec2>,
    hierarchy: Option<Hierarchy>,
    gradient: Vec<Vec2>,
    direction: Vec<Vec2>,
    /// Room for a sweep to work in.
    moved: Vec<DVec2>,
}

impl<'a> CpuFine<'a> {
    /// The mesh at `positions`, normalized and in the problem's order.
    pub(crate) fn new(problem: &'a Problem, positions: Vec<DVec2>, plan: &Plan) -> Self {
        let sharpness = plan.sharpness.last;
        Self {
            problem,
            metric: plan.scheme.base(),
            tracked: plan.tracked(),
            step: Step {
                omega: 1.0,
                inner: plan.inner,
                sharpness,
                derivatives: Derivatives::Analytic,
            },
            hierarchy: None,
            gradient: Vec::new(),
            direction: Vec::new(),
            moved: Vec::new(),
            positions,
        }
    }

    fn try_length(&self, length: f64) -> Option<f64> {
        let Self { positions, direction, .. } = self;
        mean_excess_along(self.metric, self.problem, &Along { positions, direction, length })
    }

    /// The derivative of the mean excess along the correction.
    fn slope(&self) -> f64 {
        let parts = self.gradient.par_chunks(CHUNK).zip(self.direction.par_chunks(CHUNK));
        let dot = |(g, d): (&[Vec2], &[Vec2])| -> f64 {
            g.iter().zip(d).map(|(g, d)| g.as_dvec2().dot(d.as_dvec2())).sum()
        };
        // Added up in order, whatever the threads.
        let parts: Vec<f64> = parts.map(dot).collect();
        parts.iter().sum::<f64>() / self.problem.triangles().len() as f64
    }
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
        sweep::sweep(self.metric, self.problem, &mut self.positions, &mut self.moved, &step);
        Ok(())
    }

    async fn positions(&mut self) -> Result<Cow<'_, [DVec2]>, GpuError> {
        Ok(Cow::Borrowed(&self.positions))
    }

    fn hierarchy(&mut self) -> Option<Hierarchy> {
        self.hierarchy.take()
    }

    fn set_hierarchy(&mut self, hierarchy: Hierarchy) -> Result<(), GpuError> {
        self.hierarchy = Some(hierarchy);
        Ok(())
    }

    async fn propose(&mut self, omega: f64, length: f64) -> Result<Proposal, GpuError> {
        self.sweep(omega).await?;
        let Self { metric, problem, positions, gradient, .. } = self;
        sweep::gradient(*metric, problem, positions, self.step.sharpness, gradient);
        // Room for a direction is taken anew: that of the last goes first.
        self.direction = Vec::new();
        self.direction = match &self.hierarchy {
            Some(hierarchy) => vcycle::correction(hierarchy, problem, gradient),
            None => vec![Vec2::ZERO; gradient.len()],
        };
        let slope = self.slope();
        let here = mean_excess(self.metric, self.problem, &self.positions);
        let there = if slope < 0.0 { self.try_length(length) } else { None };
        Ok(Proposal { here, slope, there })
    }

    async fn objective_along(&mut self, length: f64) -> Result<Option<f64>, GpuError> {
        Ok(self.try_length(length))
    }

    async fn take(&mut self, length: f64) -> Result<(), GpuError> {
        let along = self.direction.par_chunks(CHUNK);
        self.positions.par_chunks_mut(CHUNK).zip(along).for_each(|(positions, along)| {
            for (position, along) in positions.iter_mut().zip(along) {
                *position += along.as_dvec2() * length;
            }
        });
        Ok(())
    }
}
