//! A mesh made ready, and what a run makes of it.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use glam::DVec2;

use crate::cpu::{CpuEngine, mean_excess};
use crate::error::{MeshError, SmoothError};
use crate::gpu::{Gpu, GpuEngine, MeshSize, Waiting};
use crate::layout::Problem;
use crate::layout::prepare;
use crate::mesh::Mesh;
use crate::metric::Metric;
use crate::metric::Scheme;
use crate::quality::Quality;
use crate::run::opening::{self, Opened};
use crate::run::{
    Desired, Goal, Method, NOISE, Objectives, Observer, Options, Phase, Plan, Sharpness, Stop,
    Strategy, drive, shape_guard,
};
use crate::topology::{Topology, certify};

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
    topology: Topology<'a>,
    problem: Problem,
    prepare: Duration,
}

/// What a run made of the mesh.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Position of every vertex, in the mesh's order and units: the best state by the base metric, or the mesh as it was
    /// where f of that state, on these very values, is not lower by more than rounding.
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
    /// The share of f that is estimated to be left to gain at the end, from the decay of the last sweeps; `None` where
    /// that says nothing.
    pub remaining: Option<f64>,
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
        let (mut topology, problem) = prepare(mesh)?;
        // What runs are given is the problem. Only a vertex that goes back needs its star again.
        topology.forget_stars();
        Ok(Self { mesh, topology, problem, prepare: start.elapsed() })
    }

    /// The mesh's windings, boundary and free vertices.
    pub fn topology(&self) -> &Topology<'a> {
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
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex.
    pub fn quality(&self, points: &[[f64; 2]]) -> Result<Quality, MeshError> {
        Quality::of(points, &self.topology)
    }

    /// Sends vertices of inverted or flat triangles back to where the mesh had them, in place, and
    /// returns how many; see [`validity::certify`](crate::validity::certify). To be called when `points` were rounded
    /// again after [`Self::run`].
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex. Nothing is moved then.
    pub fn certify(&self, points: &mut [[f64; 2]]) -> Result<usize, MeshError> {
        certify(&self.topology, &self.mesh.points, points)
    }

    /// Smooths the mesh. Blocks until the run ends; `observe` is called every few sweeps and may end
    /// it, the best state so far being returned all the same.
    ///
    /// # Errors
    /// [`SmoothError`] if an option makes no sense or the device fails; [`GpuError::Limit`](crate::GpuError::Limit) before anything is done if the
    /// mesh does not fit it.
    pub fn run(
        &self,
        options: &Options,
        backend: &Backend,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Outcome, SmoothError> {
        let device = match backend {
            Backend::Cpu => None,
            Backend::Gpu(gpu) => Some((gpu, Waiting::Block)),
        };
        pollster::block_on(self.run_at(options, device, observe))
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
        self.run_at(options, Some((gpu, Waiting::Await)), observe).await
    }

    async fn run_at(
        &self,
        options: &Options,
        device: Option<(&Gpu, Waiting)>,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Outcome, SmoothError> {
        let start = Instant::now();
        options.check()?;
        if let Some((gpu, waiting)) = device {
            gpu.check_size(self.size())?;
            gpu.arithmetic_checked(waiting).await?;
        }
        let base = options.scheme.base();
        let initial = self.objective(base, self.problem.positions());
        let goal = match options.goal {
            Some(goal) => Some(self.aim(goal, options, device, observe).await?),
            None => None,
        };
        let target = goal.as_ref().map(|goal| initial - goal.fraction * (initial - goal.desired));

        let run = Run { problem: &self.problem, device, phase: Phase::Smoothing };
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
        let mut points = self.problem.denormalize(self.mesh, &end.positions);
        let mut returned = self.certify(&mut points)?;
        // Judged as they will stand: rounding, and vertices that went back, may have cost more than was gained, and a
        // device moves vertices of an optimal mesh by its own rounding.
        let written = self.objective(base, &self.problem.normalized(&points, end.positions));
        let gains = initial - written > NOISE * initial;
        if !gains {
            points.clone_from(&self.mesh.points);
            returned = 0;
        }
        let best = if gains { written } else { initial };
        let goal = goal.map(|goal| {
            let gone = (initial - best) / (initial - goal.desired);
            // Nothing to go is all the way gone.
            GoalOutcome { best_fraction: if gone.is_nan() { 1.0 } else { gone }, ..goal }
        });
        Ok(Outcome {
            points,
            stop: end.stop,
            sweeps: end.history.len() as u32 - 1,
            corrections: end.corrections,
            opening_sweeps: end.opening_sweeps,
            levels_left_out: end.levels_left_out,
            best_sweep: if gains { best_sweep as u32 } else { 0 },
            remaining: end.remaining,
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
        device: Option<(&Gpu, Waiting)>,
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
        let run = Run { problem: &self.problem, device, phase: Phase::Reference };
        let start = self.problem.positions();
        let mut starts = vec![(format!("{base} alone"), start.to_vec())];
        if !base.properties().is_inverse_mean_ratio {
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

/// Sweeps from some positions to the end, on the CPU or a device.
struct Run<'s> {
    problem: &'s Problem,
    device: Option<(&'s Gpu, Waiting)>,
    phase: Phase,
}

/// What a run leaves, the sweeps that opened it included.
struct Ran {
    history: Vec<Objectives>,
    positions: Vec<DVec2>,
    corrections: u32,
    opening_sweeps: u32,
    levels_left_out: bool,
    remaining: Option<f64>,
    stop: Stop,
}

impl Run<'_> {
    async fn sweep(
        &self,
        options: &Options,
        target: Option<f64>,
        from: &[DVec2],
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Ran, SmoothError> {
        let problem = self.problem;
        let mut plan = options.plan_to(target);
        plan.shape_guard = shape_guard(problem, from, &plan.scheme);
        let (device, opened) = self.opened(&plan, from).await?;
        let done = opened.as_ref().map_or(0, Opened::sweeps);
        plan.stop.max_sweeps -= done;
        let from = opened.as_ref().map_or(from, |opened| &opened.positions);
        let corrected = options.is_multilevel();
        let must = options.method == Method::Multilevel;
        let strategy = Strategy::new(problem, &plan, corrected);
        let at = (self.phase, done);
        let end = match device {
            None => {
                let engine = CpuEngine::new(problem, from.to_vec(), &plan);
                drive(engine, &plan, strategy, must, at, observe).await?
            }
            Some((gpu, waiting)) => {
                let steps = Strategy::steps(&plan, corrected);
                // A run with corrections is judged by the host: on the device it never ends.
                let judged = if corrected { plan.clone().endless() } else { plan.clone() };
                let engine = GpuEngine::new(gpu, problem, from, judged, steps, waiting)?;
                drive(engine, &plan, strategy, must, at, observe).await?
            }
        };
        let remaining = end.history.remaining();
        let (history, positions) = match opened {
            Some(opened) => opened.followed_by(end.history, end.positions),
            None => (end.history.into_log(), end.positions),
        };
        let opening_sweeps = match (self.device, device) {
            (Some(_), None) => history.len() as u32 - 1,
            _ => done,
        };
        Ok(Ran {
            history,
            positions,
            corrections: end.corrections,
            opening_sweeps,
            levels_left_out: end.levels_left_out,
            remaining,
            stop: end.stop,
        })
    }

    /// Where to compute, and what came before it: where a triangle is too flat for a device's single precision, sweeps on
    /// the CPU that open it; or all of the run, if they cannot.
    async fn opened(
        &self,
        plan: &Plan,
        from: &[DVec2],
    ) -> Result<(Option<(&Gpu, Waiting)>, Option<Opened>), SmoothError> {
        if self.device.is_none() || !opening::is_needed(self.problem, from) {
            return Ok((self.device, None));
        }
        let engine = CpuEngine::new(self.problem, from.to_vec(), plan);
        Ok(match opening::open(self.problem, engine, plan).await? {
            Some(opened) => (self.device, Some(opened)),
            None => (None, None),
        })
    }
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
