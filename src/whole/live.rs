//! The sweeps of a whole run on several engines: in double precision while triangles are too flat for a device, on the
//! device, and on the CPU after a failure of the device. A
//! run with targets on a strongly stretched mesh is done on the CPU alone.

use std::borrow::Cow;
use std::cmp::Ordering;

use glam::DVec2;

use crate::cpu::{CpuEngine, held_back, mean_excess};
use crate::error::{GpuError, SmoothError};
use crate::layout::Problem;
use crate::options::{Guard, Method, Options};
use crate::outcome::DeviceFault;
use crate::parallel::paced;
use crate::resume;
use crate::run::opening::{self, DoublePrelude, Obstacle};
use crate::run::{
    CPU, Checkpoint, Checkpointer, Corrections, Counts, DriveError, Engine, History, Leg,
    Objectives, Observer, PeriodSource, Phase, Plan, Saved, Session, Stop, Strategy, Sweeping,
    steps,
};
use crate::slide::OnCurves;
use crate::whole::any_engine::AnyEngine;
use crate::whole::device::Device;
use crate::whole::host::objectives;
use crate::whole::relief::{Relief, relieved};

/// Largest sum of q² - ideal² with which a device begins. The limit is far below the largest f32, 3e38, as metrics of
/// size multiply powers of their arguments.
const MAX_SUM_ON_DEVICE: f64 = 1e15;

/// The mesh, device and options of a run.
#[derive(Clone, Copy)]
pub(crate) struct Spec<'s> {
    pub(crate) problem: &'s Problem,
    pub(crate) device: Option<Device<'s>>,
    pub(crate) options: &'s Options,
    pub(crate) phase: Phase,
    /// Whether the targets belong to places, so that a stage on the host moves vertices between sweeps.
    pub(crate) has_field: bool,
    /// The sliding vertices at the start of the run, `None` if no vertex slides.
    pub(crate) curves: Option<&'s OnCurves>,
}

/// A state to which a run can return, between two sweeps.
struct Point<'s> {
    /// Tracked objectives before the first sweep and after each sweep.
    log: Vec<Objectives>,
    /// Normalized positions of all vertices after the last sweep. Those of a run's start belong to the caller.
    positions: Cow<'s, [DVec2]>,
    /// The sliding vertices at these positions.
    curves: Option<OnCurves>,
}

/// A run in progress, on a single engine unless that engine fails.
pub(crate) struct Live<'s> {
    /// Layout of the mesh, with the present targets, and with local maps if the mesh is strongly stretched.
    pub(crate) problem: Problem,
    pub(crate) plan: Plan,
    spec: Spec<'s>,
    /// Device for the next sweeps. `None` for the CPU.
    device: Option<Device<'s>>,
    /// Present session. `None` before the first sweep, and once the device has failed.
    session: Option<Session<AnyEngine<'s>>>,
    /// State at the start of the run, or at the end of the latest stage that moved vertices.
    last: Point<'s>,
    /// The sliding vertices at the best positions so far.
    curves: Option<OnCurves>,
    /// Tracked objectives of the given mesh, if the run begins at means of neighbors instead.
    given: Option<Objectives>,
    opened: Option<DoublePrelude>,
    /// Number of sweeps before the CPU replaced a device, because triangles are too flat or too small for the device; 0 also if the vertices have more maps than a device stores. `None` without such
    /// a change.
    on_cpu_from: Option<u32>,
    fault: Option<DeviceFault>,
}

/// The result of a run's sweeps: positions, history, counts, and the reason of the end.
pub(crate) struct RunEnd {
    pub(crate) history: Vec<Objectives>,
    pub(crate) positions: Vec<DVec2>,
    /// The sliding vertices at these positions. `None` if no vertex slides.
    pub(crate) curves: Option<OnCurves>,
    pub(crate) counts: Counts,
    pub(crate) opening_sweeps: u32,
    pub(crate) closing_sweeps: u32,
    pub(crate) remaining: Option<f64>,
    pub(crate) held_back: usize,
    pub(crate) stop: Stop,
    pub(crate) fault: Option<DeviceFault>,
}

/// Returns the state at the start of a run from `positions`, or at the start of the period that a checkpoint continues.
fn first_point<'s>(
    spec: &Spec<'s>,
    resumed: Option<&Checkpoint>,
    positions: Cow<'s, [DVec2]>,
) -> Point<'s> {
    match resumed.and_then(|resumed| Some((&resumed.saved, resumed.period.as_ref()?))) {
        Some((saved, period)) => {
            let log = saved.log[..=period.began as usize].to_vec();
            Point { log, positions: period.before.clone().into(), curves: None }
        }
        None => Point { log: Vec::new(), positions, curves: spec.curves.cloned() },
    }
}

impl<'s> Live<'s> {
    /// Prepares a run by `plan` from the positions `from`, or from means of neighbors if sweeps cannot open extremely flat
    /// triangles at `from`. With `resumed`, the run continues from a checkpoint of a run from these positions.
    pub(crate) async fn new(
        spec: Spec<'s>,
        mut plan: Plan,
        from: &'s [DVec2],
        resumed: Option<&Checkpoint>,
        checkpointer: &mut Checkpointer<'_>,
    ) -> Result<Self, SmoothError> {
        let mut problem = with_local_maps(&spec, from).await;
        // Bounds hold from the given positions on, and plain sweeps are a sequence that the caller determines.
        let may_begin_elsewhere = !spec.has_field && !problem.is_bounded() && spec.curves.is_none();
        let relief = match spec.options.is_multilevel() && may_begin_elsewhere {
            true => relieved(spec.problem, &problem, &plan, from).await?,
            false => None,
        };
        let (from, given) = match relief {
            Some(Relief { positions, given }) => (Cow::Owned(positions), Some(given)),
            None => (Cow::Borrowed(from), None),
        };
        if given.is_some() {
            problem = with_local_maps(&spec, &from).await;
        }
        let is_for_cpu_alone = problem.is_for_cpu_alone();
        let (device, opened) = match resumed {
            Some(Checkpoint { about, saved, .. }) => {
                let is_on_device = saved.engine.engine != CPU && !is_for_cpu_alone;
                (spec.device.filter(|_| is_on_device), about.opened.clone())
            }
            None if is_for_cpu_alone => (None, None),
            None => opened(&spec, &plan, &from).await?,
        };
        checkpointer.last = resumed.map(|resumed| resumed.saved.clone());
        let opening_sweeps = opened.as_ref().map_or(0, DoublePrelude::sweeps);
        plan.stop.max_sweeps = plan.stop.max_sweeps.saturating_sub(opening_sweeps);
        let positions = match &opened {
            Some(opened) => Cow::Owned(paced::copied(&opened.positions).await),
            None => from,
        };
        let on_cpu_from = match resumed {
            Some(Checkpoint { about, .. }) => about.on_cpu_from,
            None => (spec.device.is_some() && device.is_none()).then_some(0),
        };
        if let Some(about) = &mut checkpointer.about {
            about.opened.clone_from(&opened);
            about.on_cpu_from = on_cpu_from;
        }
        let last = first_point(&spec, resumed, positions);
        Ok(Self {
            problem,
            plan,
            spec,
            device,
            session: None,
            last,
            curves: spec.curves.cloned(),
            given,
            opened,
            on_cpu_from,
            fault: None,
        })
    }

    /// Returns whether corrections from coarser levels follow the sweeps.
    fn is_corrected(&self) -> bool {
        self.spec.options.is_multilevel() && self.problem.free_count() > 0
    }

    /// Returns the number of completed sweeps, without the sweeps that opened triangles for a device.
    pub(crate) fn sweeps(&self) -> u32 {
        let log =
            self.session.as_ref().map_or(&self.last.log[..], |session| session.history().log());
        (log.len() as u32).saturating_sub(1)
    }

    /// Returns the positions at the start of the run, or at the end of the latest stage that moved vertices.
    pub(crate) fn start(&self) -> &[DVec2] {
        &self.last.positions
    }

    /// Sweeps until the run has done `until` sweeps, or ends before. Returns the best positions, and the reason if the
    /// run ends. `period` is the source of the state of the host and the stage, for checkpoints.
    pub(crate) async fn sweep(
        &mut self,
        until: u32,
        period: PeriodSource<'_>,
        checkpointer: &mut Checkpointer<'_>,
        observe: &mut dyn Observer,
    ) -> Result<(Vec<DVec2>, Option<Stop>), SmoothError> {
        loop {
            match self.try_to_sweep(until, period, checkpointer, observe).await {
                Ok(done) => return Ok(done),
                Err(DriveError::Device(error)) => self.fall_back(error, checkpointer)?,
                Err(DriveError::NotFinite { sweep }) => {
                    let error = GpuError::NotFinite { sweep };
                    if self.device.is_none() || self.fall_back(error, checkpointer).is_err() {
                        // Sweeps after the last period may have moved vertices to where f by the field is larger.
                        let saved = checkpointer.last.take().filter(|_| !self.spec.has_field);
                        return Ok((self.undone(saved).await, Some(Stop::NotFinite)));
                    }
                }
                Err(DriveError::LeftOut(error)) => return Err(error.into()),
                Err(DriveError::Foreign) => return Err(resume::foreign()),
            }
        }
    }

    async fn try_to_sweep(
        &mut self,
        until: u32,
        period: PeriodSource<'_>,
        checkpointer: &mut Checkpointer<'_>,
        observe: &mut dyn Observer,
    ) -> Result<(Vec<DVec2>, Option<Stop>), DriveError> {
        let mut session = match self.session.take() {
            Some(session) => session,
            None => self.begun(checkpointer.last.clone()).await?,
        };
        let done = self.opened.as_ref().map_or(0, DoublePrelude::sweeps);
        let requires_levels = self.spec.options.method == Method::Multilevel;
        let leg = Leg { until, requires_levels, phase: self.spec.phase, done, period };
        let stop = session.advance(leg, checkpointer, observe).await?;
        let positions = session.engine.best_positions().await?;
        self.curves = session.engine.best_curves().await?;
        self.session = Some(session);
        Ok((positions, stop))
    }

    /// Creates an engine in a saved state, or in the state that `last` has.
    async fn begun(&self, saved: Option<Saved>) -> Result<Session<AnyEngine<'s>>, DriveError> {
        let Self { problem, plan, last: Point { log, positions, curves }, .. } = self;
        let corrected = self.is_corrected();
        let engine = match self.device {
            None => AnyEngine::Cpu(Box::new(CpuEngine::new(
                problem,
                paced::copied(positions).await,
                curves.clone(),
                plan,
            ))),
            Some(device) => {
                // The host judges runs with corrections or a target field, so the device must not end them.
                let is_judged_by_host = corrected || self.spec.has_field;
                let judged = if is_judged_by_host { plan.clone().endless() } else { plan.clone() };
                let steps = steps(plan, corrected);
                AnyEngine::Device(
                    device.engine(problem, positions, curves.as_ref(), judged, steps).await?,
                )
            }
        };
        let has_field = self.spec.has_field;
        let strategy = match corrected {
            true => Strategy::Corrected(Box::new(Corrections::new(problem, plan, has_field))),
            false => {
                let is_held = has_field || problem.is_bounded() || problem.free_count() == 0;
                Strategy::Sweeps(Sweeping::new(plan, self.spec.options.method, is_held))
            }
        };
        let mut session = Session::new(engine, plan, strategy, log);
        if let Some(saved) = saved {
            session.restore(saved).await?;
        }
        Ok(session)
    }

    /// Leaves the device after `sweep` sweeps, as the run continues on the CPU. Checkpoints and the report state the
    /// change.
    fn leave_device(&mut self, sweep: u32, checkpointer: &mut Checkpointer<'_>) {
        self.device = None;
        self.on_cpu_from = Some(sweep);
        if let Some(about) = &mut checkpointer.about {
            about.on_cpu_from = self.on_cpu_from;
        }
    }

    /// Leaves a device that has failed, so that the run continues on the CPU. Returns the error if the run has no device,
    /// or if the policy refuses.
    fn fall_back(
        &mut self,
        error: GpuError,
        checkpointer: &mut Checkpointer<'_>,
    ) -> Result<(), SmoothError> {
        let last = (self.last.log.len() as u32).saturating_sub(1);
        let done = self.opened.as_ref().map_or(0, DoublePrelude::sweeps);
        let sweep = checkpointer.last.as_ref().map_or(last, Saved::sweeps) + done;
        if self.device.is_none() || !checkpointer.policy.falls_back_to_cpu(&error, sweep) {
            return Err(error.into());
        }
        (self.device, self.session) = (None, None);
        self.fault = Some(DeviceFault { sweep, error });
        Ok(())
    }

    /// Returns to the last saved state, or to the state of `last`, because a later sweep made f infinite or NaN.
    /// Returns the positions of this state.
    async fn undone(&mut self, saved: Option<Saved>) -> Vec<DVec2> {
        if let Some(Saved { log, engine, .. }) = saved {
            let mut curves = self.last.curves.take();
            let best = curves.as_mut().and_then(|curves| curves.restore(&engine)).flatten();
            if let (Some(curves), Some(best)) = (&mut curves, best) {
                curves.set_params(&best);
            }
            let positions = engine.best.unwrap_or(engine.positions).into();
            self.last = Point { log, positions, curves };
        }
        if self.last.log.is_empty() {
            self.last.log = vec![objectives(&self.problem, &self.plan, &self.last.positions).await];
        }
        self.session = None;
        self.curves.clone_from(&self.last.curves);
        self.last.positions.to_vec()
    }

    /// Records the changes of the stage after sweep `from`: the positions of vertices and the targets. Sends the changes to the engine.
    pub(crate) async fn write_back(
        &mut self,
        from: u32,
        moved: Moved<'_>,
        checkpointer: &mut Checkpointer<'_>,
    ) -> Result<(), SmoothError> {
        let Moved { positions, swept_to, targets, now } = moved;
        let Some(mut session) = self.session.take() else { return Ok(()) };
        session.disturbed(from, now);
        // The state that was saved before belongs to other positions and targets.
        checkpointer.last = None;
        self.last = Point {
            log: session.history().log().to_vec(),
            positions: positions.to_vec().into(),
            curves: self.curves.clone(),
        };
        let mut changed = || -> Result<(), GpuError> {
            if let Some(problem) = targets {
                session.set_targets(problem)?;
            }
            if positions != swept_to {
                session.engine.set_positions(positions)?;
            }
            Ok(())
        };
        let written = changed();
        if let Some(problem) = targets {
            self.problem = problem.clone();
        }
        match written {
            Ok(()) => self.session = Some(session),
            Err(error) => self.fall_back(error, checkpointer)?,
        }
        // A device cannot sweep a mesh with triangles that a stage has made too flat.
        if self.device.is_some()
            && positions != swept_to
            && opening::obstacle(&self.problem, positions).await != Obstacle::None
        {
            self.leave_device(self.sweeps(), checkpointer);
            self.session = None;
        }
        Ok(())
    }

    /// Ends the run for the reason `stop`, with the vertices at `positions`.
    pub(crate) async fn end(self, positions: Vec<DVec2>, mut stop: Stop) -> RunEnd {
        let Self { plan, problem, last, session, curves, .. } = self;
        let (counts, remaining, history) = match session {
            Some(session) => {
                let history = session.history();
                (session.counts(), history.remaining(), history.clone())
            }
            None => {
                let history = History::resumed(&plan, &last.log, None);
                (Counts { alternated: history.sweeps(), ..Counts::NONE }, None, history)
            }
        };
        let mut held = 0;
        let step = plan.base_step(1.0);
        let can_be_held = matches!(stop, Stop::Converged | Stop::MaxSweeps);
        if can_be_held && step.shape_guard.is_finite() && problem.free_count() > 0 {
            held = held_back(&problem, &positions, &step).await;
            if held > 0 && self.spec.options.guard == Guard::ByMetric && stop == Stop::Converged {
                stop = Stop::HeldBack;
            }
        }
        let opened = self.opened.as_ref().map_or(0, DoublePrelude::sweeps);
        let from = self.on_cpu_from.filter(|_| self.spec.device.is_some());
        let on_cpu = from.map_or(0, |from| history.sweeps().saturating_sub(from));
        let (opening_sweeps, closing_sweeps) = match from {
            Some(1..) => (opened, on_cpu),
            _ => (opened + on_cpu, 0),
        };
        // The sweeps that opened triangles moved no vertex along a curve.
        let is_from_opening =
            self.opened.as_ref().is_some_and(|opened| opened.least < history.least());
        let curves = if is_from_opening { self.spec.curves.cloned() } else { curves };
        let (mut history, positions) = match self.opened {
            Some(opened) => opened.followed_by(history, positions),
            None => (history.into_log(), positions),
        };
        if let Some(given) = self.given {
            // The move to means of neighbors belongs to the first sweep. Without sweeps, the move counts as a sweep.
            match history.len() {
                1 => history.insert(0, given),
                _ => history[0] = given,
            }
        }
        RunEnd {
            history,
            positions,
            curves,
            counts: Counts { alternated: opened + counts.alternated, ..counts },
            opening_sweeps,
            closing_sweeps,
            remaining,
            held_back: held,
            stop,
            fault: self.fault,
        }
    }
}

/// Returns the layout of the mesh, with local maps if a run with corrections needs local coordinates at `positions`.
async fn with_local_maps(spec: &Spec<'_>, positions: &[DVec2]) -> Problem {
    let mut problem = spec.problem.clone();
    if spec.options.is_multilevel() && problem.is_strongly_stretched(positions) {
        problem.set_local_maps_at(positions).await;
    }
    problem
}

/// The changes that the stage of a target field makes between sweeps.
pub(crate) struct Moved<'h> {
    pub(crate) positions: &'h [DVec2],
    /// Positions at the end of the sweeps, before the stage moved vertices.
    pub(crate) swept_to: &'h [DVec2],
    /// The problem with new targets. `None` if the targets have not changed.
    pub(crate) targets: Option<&'h Problem>,
    /// Objectives at `positions`, by the present targets.
    pub(crate) now: Objectives,
}

/// Opens triangles that are too flat for a device by sweeps on the CPU. Returns the device of the run and these sweeps,
/// if any were needed. The run stays on the CPU, without a device, if a triangle is too small for the device, or if the
/// sweeps cannot open every triangle.
async fn opened<'s>(
    spec: &Spec<'s>,
    plan: &Plan,
    from: &[DVec2],
) -> Result<(Option<Device<'s>>, Option<DoublePrelude>), SmoothError> {
    let &Spec { problem, device, .. } = spec;
    if device.is_none() {
        return Ok((None, None));
    }
    // If sizes of triangles differ very much, sums of some metrics exceed the range of single precision.
    let mut metrics = plan.tracked();
    metrics.extend(plan.scheme.metrics());
    for metric in metrics {
        if metric.properties().is_inverse_mean_ratio {
            continue;
        }
        let sum =
            mean_excess(metric, problem, from).await * problem.judged_triangles().len() as f64;
        // A sum of NaN counts as too large.
        if sum.partial_cmp(&MAX_SUM_ON_DEVICE) != Some(Ordering::Less) {
            return Ok((None, None));
        }
    }
    match opening::obstacle(problem, from).await {
        Obstacle::None => return Ok((device, None)),
        Obstacle::Flat => {}
        Obstacle::Small => return Ok((None, None)),
    }
    let engine = CpuEngine::new(problem, paced::copied(from).await, None, plan);
    Ok(match opening::open(problem, engine, plan).await? {
        Some(opened) => (device, Some(opened)),
        None => (None, None),
    })
}
