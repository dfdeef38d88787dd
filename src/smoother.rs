//! A prepared mesh, and its runs.

use std::ops::ControlFlow;
use std::time::Duration;

use glam::DVec2;
use web_time::Instant;

use crate::cpu::mean_excess;
use crate::error::{MeshError, SmoothError};
use crate::gpu::{Gpu, MeshSize, Waiting};
use crate::layout::Problem;
use crate::layout::prepare;
use crate::mesh::Mesh;
use crate::metric::Metric;
use crate::metric::Scheme;
use crate::outcome::{DeviceFault, GoalOutcome, Outcome};
use crate::quality::Quality;
use crate::resume;
use crate::run::{
    Checkpoint, Desired, Goal, JITTER, Keeper, Keeping, NOISE, NoKeeper, Objectives, Observer,
    Options, Phase, ROUNDING, Sharpness, Stop,
};
use crate::slide::{Slide, Sliding};
use crate::targets::{Outside, TargetField, Targets};
use crate::topology::{Topology, certify};
use crate::whole::altitude::{self, Floor};
use crate::whole::{Attempt, Bound, Improving, Limit, Places, Rounds, in_rounds};

/// The processor that does the sweeps.
pub enum Backend {
    /// All cores of the CPU, in double precision.
    Cpu,
    /// A wgpu device.
    Gpu(Gpu),
}

/// A mesh prepared for smoothing: its topology, coloring and layout. Serves any number of runs.
pub struct Smoother<'a> {
    mesh: &'a Mesh,
    topology: Topology<'a>,
    problem: Problem,
    sliding: Option<Sliding>,
    /// The targets of places, if targets do not belong to vertices.
    field: Option<TargetField>,
    prepare: Duration,
}

impl<'a> Smoother<'a> {
    /// Prepares a mesh.
    ///
    /// # Errors
    /// [`MeshError`] if the mesh cannot be smoothed: see [`Topology::new`] and [`Topology::check_smoothable`].
    pub fn new(mesh: &'a Mesh) -> Result<Self, MeshError> {
        let start = Instant::now();
        let (mut topology, problem) = prepare(mesh)?;
        // Runs need the problem alone. Stars are found again if a vertex has to be set back.
        topology.forget_stars();
        Ok(Self { mesh, topology, problem, sliding: None, field: None, prepare: start.elapsed() })
    }

    /// Sets what elements are to look like in further runs, in place of equilateral ones of one size: one target for each
    /// vertex of the mesh. f is then that of the triangles as their targets show them.
    ///
    /// # Errors
    /// [`MeshError::ValueCount`] if there is not one target for each vertex.
    pub fn set_targets(&mut self, targets: &Targets) -> Result<(), MeshError> {
        targets.check_count(self.mesh.points.len())?;
        self.problem.set_targets(targets.maps());
        self.field = None;
        Ok(())
    }

    /// Sets what elements are to look like at each place, in place of targets that belong to vertices. A run then goes in rounds of
    /// sweeps, after each of which targets are taken from where the vertices have moved to. f is that by the targets of the places
    /// where vertices are, at the end of each round, and does not rise. As sweeps see targets that stand still, a run ends where
    /// they lead to no lower f, which may be above the least there is. Returns which vertices are outside of the field's mesh.
    ///
    /// # Errors
    /// [`MeshError::NotFinite`] if a vertex is at no place.
    pub fn set_target_field(&mut self, field: TargetField) -> Result<Outside, MeshError> {
        let (targets, outside) = field.at(&self.mesh.points)?;
        self.set_targets(&targets)?;
        self.field = Some(field);
        Ok(outside)
    }

    /// Lets vertices slide along the boundary and other curves in further runs; `None` for none. Returns how many vertices may.
    ///
    /// # Errors
    /// [`SmoothError::Option`] if a number is out of its range, [`MeshError::IndexOutOfRange`] if a vertex is listed that the mesh does
    /// not have.
    pub fn set_slide(&mut self, slide: Option<&Slide>) -> Result<usize, SmoothError> {
        self.sliding = None;
        let Some(slide) = slide else { return Ok(0) };
        let vertices = self.mesh.points.len();
        slide.check(vertices)?;
        let sliding = Sliding::new(&self.mesh.points, &self.topology, slide);
        let sliding = sliding.numbered(&self.problem, vertices);
        self.topology.forget_stars();
        let count = sliding.count();
        self.sliding = (count > 0).then_some(sliding);
        Ok(count)
    }

    /// The objective by a metric with the vertices at `points`, as targets show the triangles if there are any; see
    /// [`Self::set_targets`] and [`Self::set_target_field`].
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex, [`MeshError::NotFinite`] for a point at which there is
    /// no target.
    pub fn f(&self, metric: Metric, points: &[[f64; 2]]) -> Result<f64, MeshError> {
        self.topology.check_count(points)?;
        let positions = self.problem.normalized(points, Vec::new());
        let Some(field) = &self.field else { return Ok(self.objective(metric, &positions)) };
        let mut places = Places::new(self.mesh, field, &self.problem);
        places.follow(&positions)?;
        Ok(metric.ideal_squared() + mean_excess(metric, &places.problem, &positions))
    }

    /// The mesh's windings, boundary and free vertices.
    pub fn topology(&self) -> &Topology<'a> {
        &self.topology
    }

    /// Number of colors that the free vertices have.
    pub fn colors(&self) -> usize {
        self.problem.colors().len()
    }

    /// Time spent in [`Self::new`].
    pub fn prepare_time(&self) -> Duration {
        self.prepare
    }

    /// Number of triangles, and of vertices that some triangle uses.
    pub fn size(&self) -> MeshSize {
        let triangles = self.problem.triangles().len();
        MeshSize { vertices: self.problem.positions().len(), triangles }
    }

    /// Quality statistics of the mesh with its vertices at `points`.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex.
    pub fn quality(&self, points: &[[f64; 2]]) -> Result<Quality, MeshError> {
        Quality::of(points, &self.topology)
    }

    /// Sets the vertices of inverted or flat triangles back to their positions in the mesh, in place, and
    /// returns how many; see [`validity::certify`](crate::validity::certify). Needed if `points` are rounded
    /// again after [`Self::run`].
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex. Nothing is moved then.
    pub fn certify(&self, points: &mut [[f64; 2]]) -> Result<usize, MeshError> {
        certify(&self.topology, &self.mesh.points, points)
    }

    /// Smooths the mesh. Blocks until the run ends. `observe` is called every few sweeps and can end the run;
    /// the best state so far is then returned.
    ///
    /// # Errors
    /// [`SmoothError::Option`] if an option is out of its range, [`SmoothError::Gpu`] if the device fails. If the mesh
    /// does not fit the device, [`GpuError::Limit`](crate::GpuError::Limit) or
    /// [`GpuError::TooLarge`](crate::GpuError::TooLarge) before anything is done.
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
        pollster::block_on(self.run_at(options, device, None, &mut NoKeeper, observe))
    }

    /// Smooths the mesh as [`run`](Self::run) does, and lets `keeper` decide what is kept of the run meanwhile: checkpoints to go on
    /// from later, and whether it goes on on the CPU if the device fails. With `from`, it goes on from a checkpoint of a run on the
    /// same mesh with the same options: on the engine that took the checkpoint, to the same bits as if that run had never been left.
    /// A run that was left on the CPU goes on there whatever the backend.
    ///
    /// # Errors
    /// Those of [`run`](Self::run), and [`SmoothError::Checkpoint`] if the checkpoint is of another run.
    pub fn run_kept(
        &self,
        options: &Options,
        backend: &Backend,
        from: Option<&Checkpoint>,
        keeper: &mut (impl Keeper + ?Sized),
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Outcome, SmoothError> {
        let device = match backend {
            Backend::Cpu => None,
            Backend::Gpu(gpu) => Some((gpu, Waiting::Block)),
        };
        pollster::block_on(self.run_at(options, device, from, keeper, observe))
    }

    /// Smooths the mesh on a device without blocking the thread while the device works.
    ///
    /// The future completes only if the application polls the device meanwhile, as one that draws frames does
    /// (`Device::poll` with `PollType::Poll` is enough). Dropping the future cancels the run without a result; if
    /// `observe` ends the run, the best state so far is returned. The future is `Send` if `observe` is.
    ///
    /// # Errors
    /// The same as those of [`run`](Self::run).
    pub async fn run_async(
        &self,
        options: &Options,
        gpu: &Gpu,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Outcome, SmoothError> {
        self.run_at(options, Some((gpu, Waiting::Await)), None, &mut NoKeeper, observe).await
    }

    async fn run_at<K: Keeper + ?Sized>(
        &self,
        options: &Options,
        mut device: Option<(&Gpu, Waiting)>,
        from: Option<&Checkpoint>,
        keeper: &mut K,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Outcome, SmoothError> {
        let start = Instant::now();
        options.check_for(&self.problem)?;
        if self.sliding.is_some() {
            in_rounds::check("slide", options, from.is_some())?;
        }
        if options.max_move.is_some() {
            Limit::check(options, from.is_some())?;
        }
        if self.field.is_some() {
            Places::check(options, from.is_some())?;
            if self.sliding.is_some() {
                let (option, value) = ("target field", "with sliding vertices".to_owned());
                let remedy = "set one of the two, or targets of vertices";
                return Err(SmoothError::Option { option, value, remedy });
            }
        }
        if options.keep_altitude {
            altitude::check(options, from.is_some())?;
            if self.field.is_some() {
                let (option, value) = ("keep altitude", "on".to_owned());
                let remedy = "it does not go with targets of places";
                return Err(SmoothError::Option { option, value, remedy });
            }
        }
        let mut fault = None;
        if let Some((gpu, waiting)) = device {
            gpu.check_size(self.size())?;
            if let Err(error) = gpu.arithmetic_checked(waiting).await {
                if !keeper.goes_on_without(&error, 0) {
                    return Err(error.into());
                }
                (device, fault) = (None, Some(DeviceFault { sweep: 0, error }));
            }
        }
        let mut about = resume::about(self.mesh, self.problem.targets(), options);
        let resumed = from
            .map(|from| resume::check(&about, from, self.size().vertices).map(|()| from))
            .transpose()?;
        let base = options.scheme.base();
        let initial = self.objective(base, self.problem.positions());
        if !initial.is_finite() {
            let triangle = self.quality(&self.mesh.points)?.worst_triangle;
            let metric = base.properties().name;
            return Err(MeshError::BeyondPrecision { triangle, metric }.into());
        }
        let known = resumed.and_then(|resumed| resumed.about.goal.clone());
        let goal = match (options.goal, known) {
            (Some(Goal { fraction, .. }), Some((desired, origin))) => {
                Some(GoalOutcome { fraction, desired, origin, best_fraction: 0.0 })
            }
            (Some(goal), None) => match self.aim(goal, options, device, keeper, observe).await? {
                Some(aimed) => Some(aimed),
                None => return Ok(self.unchanged(base, initial, start)),
            },
            (None, _) => None,
        };
        let target = goal.as_ref().map(|goal| initial - goal.fraction * (initial - goal.desired));

        let run = Attempt { problem: &self.problem, device, phase: Phase::Smoothing, done: 0 };
        let monotone = options.plan_to(target).is_monotone();
        about.goal = goal.as_ref().map(|goal| (goal.desired, goal.origin.clone()));
        let mut keeping = Keeping::new(keeper);
        keeping.about = Some(about);
        let positions = self.problem.positions();
        let mut rounds = self.sliding.as_ref().map(Rounds::new);
        let mut places =
            self.field.as_ref().map(|field| Places::new(self.mesh, field, &self.problem));
        let mut limit = options.max_move.map(|most| {
            let bound = (most, options.stored);
            Limit::new(self.mesh, &self.topology, &self.problem, bound)
        });
        let mut end = match (&mut rounds, &mut places, &mut limit) {
            (_, Some(places), _) => {
                keeping.about = None;
                places.run(run, options, &mut keeping, observe).await?
            }
            (Some(rounds), ..) => {
                // A checkpoint does not hold where vertices have slid.
                keeping.about = None;
                let mut floor = options.keep_altitude.then(|| Floor::new(self.mesh, &self.problem));
                let bound = match (&mut limit, &mut floor) {
                    (Some(limit), _) => Bound::Moves(limit),
                    (None, Some(floor)) => Bound::Altitudes(floor),
                    (None, None) => Bound::None,
                };
                rounds.run(run, (options, target), bound, &mut keeping, observe).await?
            }
            (_, _, Some(limit)) => {
                keeping.about = None;
                limit.run(run, options, target, &mut keeping, observe).await?
            }
            _ if options.keep_altitude => {
                keeping.about = None;
                let (all, goal) = ((self.mesh, &self.problem), (options, target));
                altitude::run(all, run, goal, &mut keeping, observe).await?
            }
            _ => run.sweep(options, target, (positions, resumed), &mut keeping, observe).await?,
        };
        let f = |objectives: &Objectives| objectives.of(base).unwrap_or(f64::INFINITY);
        let best_sweep = if monotone {
            end.history.len() - 1
        } else {
            let better = |best: usize, k: usize| {
                if f(&end.history[k]) < f(&end.history[best]) { k } else { best }
            };
            (0..end.history.len()).fold(0, better)
        };
        let swept = f(&end.history[best_sweep]);
        let now = places.as_ref().map_or(&self.problem, |places| &places.problem);
        let bounds = limit.as_ref().map(Limit::bounds);
        let improving = Improving::after(end.stop, options, now, bounds, &mut end.positions);
        let swept = improving.as_ref().map_or(swept, |improving| improving.f[1]);
        let mut points = self.problem.denormalize(self.mesh, &end.positions);
        for (v, point) in rounds.iter().flat_map(|rounds| rounds.sliding.moved(&rounds.params)) {
            points[v as usize] = point;
        }
        for x in points.as_flattened_mut() {
            *x = options.stored.rounded(*x);
        }
        let mut returned = self.certify(&mut points)?;
        if options.keep_altitude {
            returned += altitude::restore(&self.topology, &self.mesh.points, &mut points);
            returned += self.certify(&mut points)?;
        }
        // The returned values themselves are judged: rounding, and vertices that were set back, may have cost more
        // than the sweeps gained, and a device moves the vertices of an optimal mesh by its own rounding.
        let judged = self.problem.normalized(&points, end.positions);
        let written = match &mut places {
            None => self.objective(base, &judged),
            Some(places) => {
                places.follow(&judged)?;
                base.ideal_squared() + mean_excess(base, &places.problem, &judged)
            }
        };
        let now = places.as_ref().map_or(&self.problem, |places| &places.problem);
        let gains = initial - written > NOISE * initial + ROUNDING
            || improving.as_ref().is_some_and(|improving| improving.is_better(now, &judged));
        // Of a smaller gain, the errors of f on a device would be a share to speak of.
        let lost = match initial - swept > 100.0 * JITTER * initial {
            true => ((written - swept) / (initial - swept)).clamp(0.0, 1.0),
            false => 0.0,
        };
        if !gains {
            points.clone_from(&self.mesh.points);
            returned = 0;
        }
        let slid = rounds.map(|rounds| rounds.slid(self.mesh, &self.topology, gains, &points));
        let best = if gains { written } else { initial };
        let improved = improving.map(|improving| {
            let positions = if gains { &judged } else { self.problem.positions() };
            improving.outcome(now, (positions, best), gains)
        });
        let goal = goal.map(|goal| {
            let gone = (initial - best) / (initial - goal.desired);
            // 0 / 0: the initial objective was the desired one.
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
            held_back: end.held_back,
            lost,
            history: end.history,
            goal,
            returned,
            slid,
            improved,
            device_fault: fault.or(end.fault),
            smooth: start.elapsed(),
        })
    }

    /// The outcome of a run that was cancelled before its first sweep.
    fn unchanged(&self, base: Metric, f: f64, start: Instant) -> Outcome {
        let mut objectives = Objectives::untracked();
        objectives.set(base, f);
        Outcome {
            points: self.mesh.points.clone(),
            stop: Stop::Cancelled,
            sweeps: 0,
            corrections: 0,
            opening_sweeps: 0,
            levels_left_out: false,
            best_sweep: 0,
            remaining: None,
            held_back: 0,
            lost: 0.0,
            history: vec![objectives],
            goal: None,
            returned: 0,
            slid: None,
            improved: None,
            device_fault: None,
            smooth: start.elapsed(),
        }
    }

    /// The objective by a metric at normalized positions.
    fn objective(&self, metric: Metric, positions: &[DVec2]) -> f64 {
        metric.ideal_squared() + mean_excess(metric, &self.problem, positions)
    }

    /// Determines the desired objective of a goal, by runs to convergence if it is not given; `None` if the observer
    /// ended one of them.
    async fn aim<K: Keeper + ?Sized>(
        &self,
        goal: Goal,
        options: &Options,
        device: Option<(&Gpu, Waiting)>,
        keeper: &mut K,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Option<GoalOutcome>, SmoothError> {
        let Goal { fraction, desired } = goal;
        if let Desired::Value(desired) = desired {
            let origin = "given".to_owned();
            return Ok(Some(GoalOutcome { fraction, desired, origin, best_fraction: 0.0 }));
        }
        let base = options.scheme.base();
        let full = |metric: Metric| Options {
            scheme: Scheme::from(metric),
            tolerance: 1e-8,
            max_sweeps: 5000,
            sharpness: Some(Sharpness::CONTINUED),
            guard: options.guard,
            ..Options::default()
        };
        let run = Attempt { problem: &self.problem, device, phase: Phase::Reference, done: 0 };
        let start = self.problem.positions();
        let mut starts = vec![(format!("{base} alone"), start.to_vec())];
        if !base.properties().is_inverse_mean_ratio {
            let imr = Options { tolerance: 1e-6, ..full(Metric::Imr) };
            let mut keeping = Keeping::new(&mut *keeper);
            let after_imr = run.sweep(&imr, None, (start, None), &mut keeping, observe).await?;
            if after_imr.stop == Stop::Cancelled {
                return Ok(None);
            }
            starts.push((format!("imr, then {base}"), after_imr.positions));
        }
        let mut describe = Vec::new();
        let mut desired = f64::INFINITY;
        for (label, start) in starts {
            let (options, mut keeping) = (full(base), Keeping::new(&mut *keeper));
            let end = run.sweep(&options, None, (&start, None), &mut keeping, observe).await?;
            if end.stop == Stop::Cancelled {
                return Ok(None);
            }
            let f = self.objective(base, &end.positions);
            let sweeps = end.history.len() - 1;
            describe.push(format!("{label}: {f} after {sweeps} sweeps ({})", end.stop.name()));
            desired = desired.min(f);
        }
        let origin = format!("runs to convergence; {}", describe.join("; "));
        Ok(Some(GoalOutcome { fraction, desired, origin, best_fraction: 0.0 }))
    }
}

/// Smooths a mesh given as slices, in one blocking call. `points` are positions in any unit, `triangles` zero-based
/// vertex triples in either winding. The boundary stays fixed. Returns the positions in the order of `points`.
///
/// # Errors
/// Those of [`Smoother::new`] and [`Smoother::run`].
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
