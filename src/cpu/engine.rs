//! The f64 engine: the reference for tests, and what runs where there is no adapter.
//!
//! Same colors, same steps and same stopping as the GPU engine, on all cores.

use glam::DVec2;

use crate::cpu::newton::Step;
use crate::cpu::objective::mean_excess;
use crate::cpu::sweep;
use crate::error::GpuError;
use crate::layout::Problem;
use crate::run::{Engine, Objectives};
use crate::run::{Plan, Stop, StopRule};

/// A run on the CPU.
pub struct CpuEngine<'a> {
    problem: &'a Problem,
    plan: Plan,
    positions: Vec<DVec2>,
    /// Where the vertices of a color go.
    moved: Vec<DVec2>,
    /// The best state; of a monotone scheme it is the last.
    best_positions: Option<Vec<DVec2>>,
    best_sweep: usize,
    base_history: Vec<f64>,
    stop: Option<Stop>,
}

impl<'a> CpuEngine<'a> {
    /// Starts a run from `positions`, normalized and in the problem's order.
    pub fn new(problem: &'a Problem, positions: Vec<DVec2>, plan: Plan) -> Self {
        let best_positions = (!plan.is_monotone()).then(|| positions.clone());
        Self {
            problem,
            plan,
            positions,
            moved: Vec::new(),
            best_positions,
            best_sweep: 0,
            base_history: Vec::new(),
            stop: None,
        }
    }

    /// The normalized positions after the last sweep.
    pub(crate) fn positions(&self) -> &[DVec2] {
        &self.positions
    }

    fn sweep(&mut self, sweep: u32) {
        let metric = self.plan.scheme.metric(sweep);
        let step = Step {
            omega: self.plan.omega(metric, sweep),
            inner: self.plan.inner,
            sharpness: self.plan.sharpness.of(sweep),
            derivatives: self.plan.derivatives[metric as usize],
        };
        sweep::sweep(metric, self.problem, &mut self.positions, &mut self.moved, &step);
    }

    fn evaluate(&mut self) -> Objectives {
        let mut values = Objectives::untracked();
        for metric in self.plan.tracked() {
            let excess = mean_excess(metric, self.problem, &self.positions);
            values.set(metric, metric.ideal_squared() + excess);
        }
        let base = values.of(self.plan.scheme.base()).unwrap_or(f64::NAN);
        let evaluation = self.base_history.len();
        self.base_history.push(base);
        if evaluation == 0 || base < self.base_history[self.best_sweep] {
            self.best_sweep = evaluation;
            if let Some(best) = &mut self.best_positions {
                best.copy_from_slice(&self.positions);
            }
        }
        let window = StopRule::window(&self.plan.scheme) as usize;
        self.stop = self.plan.stop.judge(&self.base_history, self.best_sweep, window);
        values
    }
}

impl Engine for CpuEngine<'_> {
    fn advance(&mut self, sweeps: u32) -> Result<Vec<Objectives>, GpuError> {
        let mut log = Vec::new();
        if self.base_history.is_empty() {
            log.push(self.evaluate());
        }
        for _ in 0..sweeps {
            if self.stop.is_some() {
                break;
            }
            self.sweep(self.base_history.len() as u32);
            log.push(self.evaluate());
        }
        Ok(log)
    }

    fn stop(&self) -> Option<Stop> {
        self.stop
    }

    fn best_positions(&mut self) -> Result<Vec<DVec2>, GpuError> {
        Ok(self.best_positions.as_ref().unwrap_or(&self.positions).clone())
    }
}
