//! The loop over sweeps, whatever the engine.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use glam::DVec2;

use crate::cpu::{CpuEngine, CpuFine, mean_excess};
use crate::engine::{Engine, Objectives};
use crate::error::{MeshError, SmoothError};
use crate::gpu::{Gpu, GpuEngine, GpuError, GpuFine, MeshSize, Waiting};
use crate::mesh::Mesh;
use crate::metric::Metric;
use crate::multilevel::MultilevelEngine;
use crate::opening::{self, Opened};
use crate::options::{Desired, Goal, Method, Options};
use crate::plan::{Sharpness, Stop};
use crate::prepare::prepare;
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

/// Hears how far a run is, and may end it: any `FnMut(&Progress) -> ControlFlow<()>`.
pub trait Observer: FnMut(&Progress) -> ControlFlow<()> {}

impl<F: FnMut(&Progress) -> ControlFlow<()> + ?Sized> Observer for F {}

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
    /// Corrections from coarser levels taken after sweeps; see [`Method::Multilevel`](crate::Method).
    pub corrections: u32,
    /// Sweeps that were done on the CPU, in double precision, though a device was asked for: the first ones, where triangles
    /// are too flat for single precision.
    pub opening_sweeps: u32,
    /// Whether [`Method::Auto`](crate::Method) did without these corrections, as the device does not bind what the
    /// coarser levels of the mesh take.
    pub levels_left_out: bool,
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
        let (topology, problem) = prepare(mesh)?;
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

    /// How large the mesh is, less the vertices that no triangle uses.
    pub fn size(&self) -> MeshSize {
        let triangles = self.problem.triangles().len();
        MeshSize { vertices: self.problem.positions().len(), triangles }
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
    /// [`SmoothError`] if an option makes no sense or the device fails; [`GpuError::Limit`] before anything is done if the
    /// mesh does not fit it.
    pub fn run(
        &self,
        options: &Options,
        backend: &Backend,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Outcome, SmoothError> {
        let place = match backend {
            Backend::Cpu => Place::Cpu,
            Backend::Gpu(gpu) => Place::Gpu(gpu, Waiting::Block),
        };
        pollster::block_on(self.run_at(options, place, observe))
    }

    /// Smooths the mesh on a device without blocking the thread while the device works.
    ///
    /// The future completes only if somebody polls the device meanwhile, as an application does that
    /// draws frames (`Device::poll` with `PollType::Poll` is enough). Dropping the future cancels the run, as
    /// `observe` can, which then returns the best state so far. The future is `Send` if `observe` is.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub async fn run_async(
        &self,
        options: &Options,
        gpu: &Gpu,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Outcome, SmoothError> {
        self.run_at(options, Place::Gpu(gpu, Waiting::Await), observe).await
    }

    async fn run_at(
        &self,
        options: &Options,
        place: Place<'_>,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Outcome, SmoothError> {
        let start = Instant::now();
        options.check()?;
        if let Place::Gpu(gpu, _) = place {
            gpu.check_size(self.size())?;
        }
        let base = options.scheme.base();
        let initial = self.objective(base, self.problem.positions());
        let goal = match options.goal {
            Some(goal) => Some(self.aim(goal, options, place, observe).await?),
            None => None,
        };
        let target = goal.as_ref().map(|goal| initial - goal.fraction * (initial - goal.desired));

        let run = Run { smoother: self, place, phase: Phase::Smoothing };
        let monotone = options.plan_to(target).is_monotone();
        let end = run.sweep(options, target, self.problem.positions(), observe).await?;
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
            corrections: end.corrections,
            opening_sweeps: end.opening_sweeps,
            levels_left_out: end.levels_left_out,
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
    async fn aim(
        &self,
        goal: Goal,
        options: &Options,
        place: Place<'_>,
        observe: &mut (impl Observer + ?Sized),
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
        let run = Run { smoother: self, place, phase: Phase::Reference };
        let start = self.problem.positions();
        let mut starts = vec![(format!("{base} alone"), start.to_vec())];
        if !matches!(base, Metric::Imr | Metric::Ar) {
            let imr = Options { tolerance: 1e-6, ..full(Metric::Imr) };
            let after_imr = run.sweep(&imr, None, start, observe).await?;
            starts.push((format!("imr, then {base}"), after_imr.positions));
        }
        let mut describe = Vec::new();
        let mut desired = f64::INFINITY;
        for (label, start) in starts {
            let end = run.sweep(&full(base), None, &start, observe).await?;
            let f = self.objective(base, &end.positions);
            let sweeps = end.history.len() - 1;
            describe.push(format!("{label}: {f} after {sweeps} sweeps ({})", end.stop.name()));
            desired = desired.min(f);
        }
        let origin = format!("over-relaxed; {}", describe.join("; "));
        Ok(GoalOutcome { fraction, desired, origin, best_fraction: 0.0 })
    }
}

/// Where a run computes, and who waits for it.
#[derive(Clone, Copy)]
enum Place<'g> {
    Cpu,
    Gpu(&'g Gpu, Waiting),
}

/// The engine of a run.
enum AnyEngine<'e> {
    Cpu(Box<CpuEngine<'e>>),
    Gpu(Box<GpuEngine<'e>>),
    CpuMultilevel(Box<MultilevelEngine<'e, CpuFine<'e>>>),
    GpuMultilevel(Box<MultilevelEngine<'e, GpuFine<'e>>>),
}

impl AnyEngine<'_> {
    async fn advance(&mut self, sweeps: u32) -> Result<Vec<Objectives>, GpuError> {
        match self {
            AnyEngine::Cpu(engine) => engine.advance(sweeps),
            AnyEngine::Gpu(engine) => GpuEngine::advance(engine, sweeps).await,
            AnyEngine::CpuMultilevel(engine) => engine.advance(sweeps).await,
            AnyEngine::GpuMultilevel(engine) => engine.advance(sweeps).await,
        }
    }

    fn stop(&self) -> Option<Stop> {
        match self {
            AnyEngine::Cpu(engine) => engine.stop(),
            AnyEngine::Gpu(engine) => engine.stop(),
            AnyEngine::CpuMultilevel(engine) => engine.stop(),
            AnyEngine::GpuMultilevel(engine) => engine.stop(),
        }
    }

    async fn best_positions(&mut self) -> Result<Vec<DVec2>, GpuError> {
        match self {
            AnyEngine::Cpu(engine) => engine.best_positions(),
            AnyEngine::Gpu(engine) => GpuEngine::best_positions(engine).await,
            AnyEngine::CpuMultilevel(engine) => engine.best_positions().await,
            AnyEngine::GpuMultilevel(engine) => engine.best_positions().await,
        }
    }

    fn corrections(&self) -> u32 {
        match self {
            AnyEngine::Cpu(_) | AnyEngine::Gpu(_) => 0,
            AnyEngine::CpuMultilevel(engine) => engine.corrections(),
            AnyEngine::GpuMultilevel(engine) => engine.corrections(),
        }
    }

    /// Why there are no corrections, if there was to be some.
    fn left_out(&self) -> Option<&GpuError> {
        match self {
            AnyEngine::Cpu(_) | AnyEngine::Gpu(_) => None,
            AnyEngine::CpuMultilevel(engine) => engine.left_out(),
            AnyEngine::GpuMultilevel(engine) => engine.left_out(),
        }
    }
}

/// Sweeps from some positions to the end.
struct Run<'s, 'a> {
    smoother: &'s Smoother<'a>,
    place: Place<'s>,
    phase: Phase,
}

struct End {
    history: Vec<Objectives>,
    positions: Vec<DVec2>,
    corrections: u32,
    opening_sweeps: u32,
    levels_left_out: bool,
    stop: Stop,
}

impl Run<'_, '_> {
    async fn sweep(
        &self,
        options: &Options,
        target: Option<f64>,
        from: &[DVec2],
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<End, SmoothError> {
        let base = options.scheme.base();
        let (place, opened) = self.opened(options, target, from);
        let done = opened.as_ref().map_or(0, Opened::sweeps);
        let options = &Options { max_sweeps: options.max_sweeps - done, ..options.clone() };
        let from = opened.as_ref().map_or(from, |opened| &opened.positions);
        let mut engine = self.engine(place, options, target, from)?;
        let mut history = Vec::new();
        let mut batch = 4;
        let stop = loop {
            let start = Instant::now();
            let log = engine.advance(batch).await?;
            batch = next_batch(batch, start.elapsed());
            history.extend_from_slice(&log);
            if let (Method::Multilevel, Some(error)) = (options.method, engine.left_out()) {
                return Err(error.clone().into());
            }
            if let Some(stop) = engine.stop() {
                break stop;
            }
            let progress = Progress {
                phase: self.phase,
                sweep: done + history.len() as u32 - 1,
                f: history.last().and_then(|o| o.of(base)).unwrap_or(f64::NAN),
            };
            if observe(&progress).is_break() {
                break Stop::Cancelled;
            }
        };
        let corrections = engine.corrections();
        let levels_left_out = engine.left_out().is_some();
        let positions = engine.best_positions().await?;
        let (history, positions) = match opened {
            Some(opened) => opened.followed_by(base, history, positions),
            None => (history, positions),
        };
        let opening_sweeps = match (self.place, place) {
            (Place::Gpu(..), Place::Cpu) => history.len() as u32 - 1,
            _ => done,
        };
        Ok(End { history, positions, corrections, opening_sweeps, levels_left_out, stop })
    }

    /// Where to compute, and what came before it: where a triangle is too flat for a device's single precision, sweeps on
    /// the CPU that open it; or all of the run, if they cannot.
    fn opened(
        &self,
        options: &Options,
        target: Option<f64>,
        from: &[DVec2],
    ) -> (Place<'_>, Option<Opened>) {
        match self.place {
            Place::Gpu(..) if opening::is_needed(&self.smoother.problem, from) => {
                match opening::open(&self.smoother.problem, from, options.plan_to(target)) {
                    Some(opened) => (self.place, Some(opened)),
                    None => (Place::Cpu, None),
                }
            }
            _ => (self.place, None),
        }
    }

    fn engine<'e>(
        &'e self,
        place: Place<'e>,
        options: &Options,
        target: Option<f64>,
        from: &'e [DVec2],
    ) -> Result<AnyEngine<'e>, GpuError> {
        let problem = &self.smoother.problem;
        let plan = options.plan_to(target);
        let multilevel = options.is_multilevel();
        Ok(match place {
            Place::Cpu if multilevel => {
                let fine = CpuFine::new(problem, from.to_vec(), &plan);
                AnyEngine::CpuMultilevel(Box::new(MultilevelEngine::new(problem, fine, &plan)))
            }
            Place::Cpu => AnyEngine::Cpu(Box::new(CpuEngine::new(problem, from.to_vec(), plan))),
            Place::Gpu(gpu, waiting) if multilevel => {
                let fine = GpuFine::new(gpu, problem, from, &plan, waiting)?;
                AnyEngine::GpuMultilevel(Box::new(MultilevelEngine::new(problem, fine, &plan)))
            }
            Place::Gpu(gpu, waiting) => {
                let engine = GpuEngine::new(gpu, problem, from, plan)?.waiting(waiting);
                AnyEngine::Gpu(Box::new(engine))
            }
        })
    }
}

/// How many sweeps to ask for next, so that the caller hears something about ten times a second.
/// Results do not depend on it.
fn next_batch(batch: u32, took: Duration) -> u32 {
    let fits = 0.1 * f64::from(batch) / took.as_secs_f64().max(1e-6);
    (fits as u32).clamp(1, 4 * batch).min(100)
}

/// Smooths a mesh given as plain slices, in one blocking call: positions in any unit, and vertex triples,
/// zero-based, in either winding. The boundary stays. Returns the positions in the same order.
///
/// # Errors
/// As [`Smoother::new`] and [`Smoother::run`].
pub fn smooth(
    points: &[[f64; 2]],
    triangles: &[[u32; 3]],
    options: &Options,
    backend: &Backend,
) -> Result<Vec<[f64; 2]>, SmoothError> {
    let mesh = Mesh { points: points.to_vec(), triangles: triangles.to_vec(), fixed: Vec::new() };
    let smoother = Smoother::new(&mesh)?;
    let outcome = smoother.run(options, backend, &mut |_| ControlFlow::Continue(()))?;
    Ok(outcome.points)
}
