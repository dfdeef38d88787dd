//! The f64 engine: the reference for tests, and what runs where there is no adapter.
//!
//! Same colors, same steps and same stopping as the GPU engine, on all cores.

mod lanes;
mod newton;
mod objective;
mod patch;

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec2;
use rayon::prelude::*;

use crate::engine::{Engine, Objectives};
use crate::gpu::GpuError;
use crate::metric::{Metric, specialize};
use crate::plan::{Plan, Stop, StopRule};
use crate::problem::Problem;
use lanes::{LANES, Points};
use newton::Step;
pub(crate) use objective::mean_excess;
use patch::Patches;

/// Vertices of one task.
const CHUNK: usize = Problem::BLOCK;

/// Positions that one task copies: fewer are not worth a second thread.
const COPY: usize = 1 << 14;

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
        let most = problem.colors().iter().map(|color| color.len()).max().unwrap_or(0);
        let best_positions = (!plan.is_monotone()).then(|| positions.clone());
        Self {
            problem,
            plan,
            positions,
            moved: vec![DVec2::ZERO; most],
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
            derivatives: self.plan.derivatives,
        };
        let level = Level::new();
        for color in self.problem.colors() {
            let first = color.start as usize;
            let moved = &mut self.moved[..color.len()];
            // Vertices of one color read each other's neighbors only, never each other.
            moved.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, moved)| {
                let (problem, positions) = (self.problem, &self.positions);
                let first = first + chunk * CHUNK;
                specialize!(metric, METRIC => {
                    dispatch!(level, simd => {
                        visit_all(simd, METRIC, problem, positions, first, &step, moved);
                    });
                });
            });
            let positions = self.positions[first..][..color.len()].par_chunks_mut(COPY);
            positions.zip(moved.par_chunks(COPY)).for_each(|(to, from)| to.copy_from_slice(from));
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

/// Visits the vertices from `first` on and writes where they go.
#[inline(always)]
fn visit_all<S: Simd>(
    simd: S,
    metric: Metric,
    problem: &Problem,
    positions: &[DVec2],
    first: usize,
    step: &Step,
    moved: &mut [DVec2],
) {
    let mut ring: Vec<Points<S>> = Vec::with_capacity(16);
    let mut done = 0;
    while done < moved.len() {
        let v = (first + done) as u32;
        let degree = problem.ring_of(v).len();
        let most = LANES.min(moved.len() - done) as u32;
        let mut count = 1;
        while count < most && problem.ring_of(v + count).len() == degree {
            count += 1;
        }
        // Lanes too many visit the last vertex again.
        let last = v + count - 1;
        let vertices = [v, last.min(v + 1), last.min(v + 2), last.min(v + 3)];
        let patches = Patches::gather(simd, problem, positions, vertices, &mut ring);
        let at = patch::points(simd, positions, vertices);
        let [x, y] = newton::visit(metric, &patches, at, step);
        let count = count as usize;
        for (lane, moved) in moved[done..done + count].iter_mut().enumerate() {
            *moved = DVec2::new(x[lane], y[lane]);
        }
        done += count;
    }
}
