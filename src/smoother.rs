//! The loop over sweeps, whatever the engine.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use glam::DVec2;

use crate::coloring::Coloring;
use crate::cpu::{CpuEngine, mean_excess};
use crate::engine::{Engine, Objectives};
use crate::error::{MeshError, SmoothError};
use crate::gpu::{Gpu, GpuEngine};
use crate::mesh::Mesh;
use crate::metric::Metric;
use crate::options::{Desired, Goal, Options};
use crate::plan::{Plan, Sharpness, Stop};
use crate::problem::Problem;
use crate::quality::Quality;
use crate::scheme::Scheme;
use crate::topology::Topology;
use crate::validity;

/// Where sweeps are done.
pub enum Backend {
    /// On all cores of the CPU, in double precision.
    Cpu,
    /// On a wgpu device.
    Gpu(Gpu),
}

/// A mesh made ready for smoothing: topology, coloring and layout. Serves any number of runs.
pub struct Smoother<'a> {
    mesh: &'a Mesh,
    topology: Topology,
    problem: Problem,
    prepare: Duration,
}

/// How far a run is, for a progress display.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// What the sweeps are for.
    pub phase: Phase,
    /// Sweeps done in this phase.
    pub sweep: u32,
    /// The base objective.
    pub f: f64,
}

/// The part of a run that is under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The optimum is sought that [`Desired::Auto`] measures by.
    Reference,
    /// The mesh is smoothed.
    Smoothing,
}

/// What a run made of the mesh.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Position of every vertex, in the mesh's order and units: the best state by the base metric.
    /// Every triangle is feasible by exact predicates on these values.
    pub points: Vec<[f64; 2]>,
    /// Why the run ended.
    pub stop: Stop,
    /// Sweeps done.
    pub sweeps: u32,
    /// The sweep after which the returned state was had; 0 is the mesh as it was.
    pub best_sweep: u32,
    /// Objectives before the first sweep and after each.
    pub history: Vec<Objectives>,
    /// How the goal was met, if there was one.
    pub goal: Option<GoalOutcome>,
    /// Vertices that went back where they were, because rounding had inverted a triangle.
    pub returned: usize,
    /// Time spent on sweeps and what belongs to them.
    pub smooth: Duration,
}

/// What became of a [`Goal`].
#[derive(Clone, Debug, PartialEq)]
pub struct GoalOutcome {
    /// The share of the way that was asked for.
    pub fraction: f64,
    /// The desired objective.
    pub desired: f64,
    /// How the desired objective was had: "given", or the run that found it.
    pub origin: String,
    /// The largest share of the way that was gone.
    pub best_fraction: f64,
}

impl<'a> Smoother<'a> {
    /// Prepares a mesh.
    ///
    /// # Errors
    /// [`MeshError`] if the mesh is not one that can be smoothed.
    pub fn new(mesh: &'a Mesh) -> Result<Self, MeshError> {
        let start = Instant::now();
        let topology = Topology::new(mesh)?;
        topology.check_smoothable(&mesh.points)?;
        let coloring = Coloring::new(&topology);
        let problem = Problem::new(mesh, &topology, &coloring);
        Ok(Self { mesh, topology, problem, prepare: start.elapsed() })
    }

    /// The mesh's windings, boundary and free vertices.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// Number of colors of the free vertices.
    pub fn colors(&self) -> usize {
        self.problem.colors().len()
    }

    /// Time spent in [`Self::new`].
    pub fn prepare_time(&self) -> Duration {
        self.prepare
    }

    /// Statistics of the mesh with its vertices at `points`.
    pub fn quality(&self, points: &[[f64; 2]]) -> Quality {
        Quality::of(points, &self.topology)
    }

    /// Sends vertices of inverted or flat triangles back to where the mesh had them, in place, and
    /// returns how many; see [`validity::certify`]. To be called when `points` were rounded again
    /// after [`Self::run`].
    pub fn certify(&self, points: &mut [[f64; 2]]) -> usize {
        validity::certify(&self.topology, &self.mesh.points, points)
    }

    /// Smooths the mesh. Blocks until the run ends; `observe` is called every few sweeps and may end
    /// it, the best state so far being returned all the same.
    ///
    /// # Errors
    /// [`SmoothError`] if an option makes no sense or the device fails.
    pub fn run(
        &self,
        options: &Options,
        backend: &Backend,
        observe: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Outcome, SmoothError> {
        let start = Instant::now();
        options.check()?;
        let base = options.scheme.base();
        let initial = self.objective(base, self.problem.positions());
        let goal = match options.goal {
            Some(goal) => Some(self.aim(goal, options, backend, observe)?),
            None => None,
        };
        let target = goal.as_ref().map(|goal| initial - goal.fraction * (initial - goal.desired));

        let run = Run { smoother: self, backend, phase: Phase::Smoothing };
        let plan = options.plan(target);
        let monotone = plan.is_monotone();
        let end = run.sweep(plan, self.problem.positions(), observe)?;
        let f = |objectives: &Objectives| objectives.of(base).unwrap_or(f64::INFINITY);
        let best_sweep = if monotone {
            end.history.len() - 1
        } else {
            let better = |best: usize, k: usize| {
                if f(&end.history[k]) < f(&end.history[best]) { k } else { best }
            };
            (0..end.history.len()).fold(0, better)
        };
        let goal = goal.map(|goal| {
            let gone = (initial - f(&end.history[best_sweep])) / (initial - goal.desired);
            // Nothing to go is all the way gone.
            GoalOutcome { best_fraction: if gone.is_nan() { 1.0 } else { gone }, ..goal }
        });
        let mut points = self.problem.denormalize(self.mesh, &end.positions);
        let returned = self.certify(&mut points);
        Ok(Outcome {
            points,
            stop: end.stop,
            sweeps: end.history.len() as u32 - 1,
            best_sweep: best_sweep as u32,
            history: end.history,
            goal,
            returned,
            smooth: start.elapsed(),
        })
    }

    fn objective(&self, metric: Metric, positions: &[DVec2]) -> f64 {
        metric.ideal_squared() + mean_excess(metric, &self.problem, positions)
    }

    /// Finds what a goal is measured by.
    fn aim(
        &self,
        goal: Goal,
        options: &Options,
        backend: &Backend,
        observe: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<GoalOutcome, SmoothError> {
        let Goal { fraction, desired } = goal;
        if let Desired::Value(desired) = desired {
            let origin = "given".to_owned();
            return Ok(GoalOutcome { fraction, desired, origin, best_fraction: 0.0 });
        }
        let base = options.scheme.base();
        let full = |metric: Metric| Options {
            scheme: Scheme::from(metric),
            tolerance: 1e-8,
            max_sweeps: 5000,
            sharpness: Sharpness::CONTINUED,
            ..Options::default()
        };
        let run = Run { smoother: self, backend, phase: Phase::Reference };
        let start = self.problem.positions();
        let mut describe = Vec::new();
        let mut desired = f64::INFINITY;
        let mut try_from = |from: &[DVec2], label: &str| -> Result<(), SmoothError> {
            let end = run.sweep(full(base).plan(None), from, observe)?;
            let f = self.objective(base, &end.positions);
            let sweeps = end.history.len() - 1;
            describe.push(format!("{label}: {f} after {sweeps} sweeps ({})", end.stop.name()));
            desired = desired.min(f);
            Ok(())
        };
        try_from(start, &format!("{base} alone"))?;
        if !matches!(base, Metric::Imr | Metric::Ar) {
            let imr = Options { tolerance: 1e-6, ..full(Metric::Imr) };
            let after_imr = run.sweep(imr.plan(None), start, &mut |_| ControlFlow::Continue(()))?;
            try_from(&after_imr.positions, &format!("imr, then {base}"))?;
        }
        let origin = format!("over-relaxed; {}", describe.join("; "));
        Ok(GoalOutcome { fraction, desired, origin, best_fraction: 0.0 })
    }
}

/// Sweeps from some positions to the end.
struct Run<'s, 'a> {
    smoother: &'s Smoother<'a>,
    backend: &'s Backend,
    phase: Phase,
}

struct End {
    history: Vec<Objectives>,
    positions: Vec<DVec2>,
    stop: Stop,
}

impl Run<'_, '_> {
    fn sweep(
        &self,
        plan: Plan,
        from: &[DVec2],
        observe: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<End, SmoothError> {
        let base = plan.scheme.base();
        let problem = &self.smoother.problem;
        let mut engine: Box<dyn Engine> = match self.backend {
            Backend::Cpu => Box::new(CpuEngine::new(problem, from.to_vec(), plan)),
            Backend::Gpu(gpu) => Box::new(GpuEngine::new(gpu, problem, from, plan)?),
        };
        let mut history = Vec::new();
        let mut batch = 4;
        let stop = loop {
            let start = Instant::now();
            let log = engine.advance(batch)?;
            batch = next_batch(batch, start.elapsed());
            history.extend_from_slice(&log);
            if let Some(stop) = engine.stop() {
                break stop;
            }
            let progress = Progress {
                phase: self.phase,
                sweep: history.len() as u32 - 1,
                f: history.last().and_then(|o| o.of(base)).unwrap_or(f64::NAN),
            };
            if observe(&progress).is_break() {
                break Stop::Cancelled;
            }
        };
        Ok(End { history, positions: engine.best_positions()?, stop })
    }
}

/// How many sweeps to ask for next, so that the caller hears something about ten times a second.
/// Results do not depend on it.
fn next_batch(batch: u32, took: Duration) -> u32 {
    let fits = 0.1 * f64::from(batch) / took.as_secs_f64().max(1e-6);
    (fits as u32).clamp(1, 4 * batch).min(100)
}
