//! The f64 engine: the reference for tests, and what runs where there is no adapter.
//!
//! Same colors, same steps and same stopping as the GPU engine, on all cores.

mod newton;

use glam::DVec2;
use rayon::prelude::*;

use crate::engine::{Engine, Objectives};
use crate::gpu::GpuError;
use crate::metric::{Corner, Metric, specialize};
use crate::plan::{Plan, Stop, StopRule};
use crate::problem::Problem;
use newton::{Patch, Step};

/// A run on the CPU.
pub struct CpuEngine<'a> {
    problem: &'a Problem,
    plan: Plan,
    positions: Vec<DVec2>,
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
            best_positions,
            best_sweep: 0,
            base_history: Vec::new(),
            stop: None,
        }
    }

    fn sweep(&mut self, sweep: u32) {
        let metric = self.plan.scheme.metric(sweep);
        let step = Step {
            omega: self.plan.omega(metric, sweep),
            inner: self.plan.inner,
            sharpness: self.plan.sharpness.of(sweep),
            derivatives: self.plan.derivatives[metric as usize],
        };
        let mut moved = Vec::new();
        for color in self.problem.colors() {
            let color = color.start as usize..color.end as usize;
            // Vertices of one color read each other's neighbors only, never each other.
            specialize!(metric, METRIC => {
                visit_all(METRIC, self.problem, &self.positions, color.clone(), &step, &mut moved);
            });
            self.positions[color].copy_from_slice(&moved);
        }
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

#[inline(always)]
fn visit_all(
    metric: Metric,
    problem: &Problem,
    positions: &[DVec2],
    color: std::ops::Range<usize>,
    step: &Step,
    moved: &mut Vec<DVec2>,
) {
    let visit = |v: usize| {
        let start = problem.ring_start();
        let ring = &problem.ring()[start[v] as usize..start[v + 1] as usize];
        let patch = Patch { ring, positions, mean_area: problem.mean_area() };
        patch.visit(metric, positions[v], step)
    };
    color.into_par_iter().with_min_len(256).map(visit).collect_into_vec(moved);
}

/// Mean of q² - ideal² over all triangles, in an order of summation that does not depend on the
/// number of threads.
pub(crate) fn mean_excess(metric: Metric, problem: &Problem, positions: &[DVec2]) -> f64 {
    let mean_area = problem.mean_area();
    let sums: Vec<f64> = specialize!(metric, METRIC => {
        let excess = |t: &[u32; 3]| {
            let [p, q, r] = t.map(|v| positions[v as usize]);
            METRIC.excess(&Corner { a: (q - p).to_array(), b: (r - p).to_array(), mean_area })
        };
        let sum = |chunk: &[[u32; 3]]| chunk.iter().map(excess).sum::<f64>();
        problem.triangles().par_chunks(1024).map(sum).collect()
    });
    sums.iter().sum::<f64>() / problem.triangles().len() as f64
}
