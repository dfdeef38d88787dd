//! A run in progress: engine, history, course, targets and point of return have no other owner.

use std::borrow::Cow;
use std::time::Duration;

use glam::DVec2;
use web_time::Instant;

use crate::cpu::{CpuEngine, objectives};
use crate::error::{GpuError, SmoothError};
use crate::layout::Problem;
use crate::options::{Method, Options};
use crate::parallel::paced;
use crate::resume;
use crate::run::opening::DoublePrelude;
use crate::run::{
    Checkpoint, CheckpointPolicy, Checkpointer, Course, Engine, History, Objectives, Observer,
    Phase, Plan, Progress, Saved, Stop,
};
use crate::slide::OnCurves;
use crate::whole::any_engine::AnyEngine;
use crate::whole::patience::Patience;
use crate::whole::place::Place;
use crate::whole::relief::{Relief, relieved};
use crate::whole::target_field::{Judgment, TargetFieldStage};

/// The mesh, options and start of a run.
#[derive(Clone, Copy)]
pub(crate) struct Spec<'s> {
    pub(crate) problem: &'s Problem,
    pub(crate) options: &'s Options,
    pub(crate) phase: Phase,
    /// Normalized positions of all vertices.
    pub(crate) from: &'s [DVec2],
    /// The sliding vertices at `from`, `None` if no vertex slides.
    pub(crate) curves: Option<&'s OnCurves>,
    /// The checkpoint from which the run continues.
    pub(crate) resumed: Option<&'s Checkpoint>,
}

/// A state to which a run can return, between two sweeps.
struct Point<'s> {
    /// Layout of the mesh, with the targets of this state, and with local maps if the mesh is strongly stretched.
    problem: Problem,
    /// Tracked objectives before the first sweep and after each sweep.
    log: Vec<Objectives>,
    /// Normalized positions of all vertices after the last sweep. Those of a run's start belong to the caller.
    positions: Cow<'s, [DVec2]>,
    /// The sliding vertices at these positions.
    curves: Option<OnCurves>,
}

impl Point<'_> {
    /// Begins the first period of a target field at this state. With a checkpoint, this state becomes that at the start of the
    /// checkpoint's period.
    async fn begin_field(
        &mut self,
        field: &mut TargetFieldStage<'_>,
        plan: &Plan,
        resumed: Option<&Checkpoint>,
    ) -> Result<(), SmoothError> {
        match resumed.and_then(|resumed| Some((&resumed.saved, resumed.period.as_ref()?))) {
            Some((saved, period)) => {
                field.restore(&mut self.problem, period).ok_or_else(resume::foreign)?;
                self.log = saved.log[..=period.began as usize].to_vec();
                self.positions = period.before.clone().into();
            }
            None => field.begin(&self.problem, plan, self.positions.to_vec()).await,
        }
        Ok(())
    }
}

/// A run in progress.
pub(crate) struct Session<'s> {
    pub(super) spec: Spec<'s>,
    pub(super) plan: Plan,
    /// The processor of the sweeps: the device or the CPU.
    pub(super) place: Place<'s>,
    /// The engine with the present positions, targets and maps. `None` before the first sweep, and after the run
    /// has left an engine.
    engine: Option<AnyEngine<'s>>,
    pub(super) course: Course,
    pub(super) history: History,
    /// The stage of a target field. `None` without a target field.
    pub(super) field: Option<TargetFieldStage<'s>>,
    /// Size, in sweeps, of the next batch, after which the observer is called. The first batch is a single sweep of
    /// unknown duration, as drivers stop submissions that take seconds.
    batch: u32,
    /// State at the start of the run, or at the end of the latest period of a target field.
    last: Point<'s>,
    /// The sliding vertices at the best positions so far.
    pub(super) curves: Option<OnCurves>,
    /// Tracked objectives of the given mesh, if the run begins at means of neighbors instead.
    pub(super) given: Option<Objectives>,
    /// The sweeps that opened triangles for the device.
    pub(super) opened: Option<DoublePrelude>,
    checkpointer: Checkpointer<'s>,
}

/// The reason why the sweeps of an engine cannot continue.
enum Failure {
    /// The device failed.
    Device(GpuError),
    /// The run requires the coarser levels, but the device has no room for them.
    LeftOut(GpuError),
    /// f is infinite or NaN after the given sweep.
    NotFinite { sweep: u32 },
    /// The saved state does not fit the mesh, the plan or the engine.
    Foreign,
}

impl From<GpuError> for Failure {
    fn from(error: GpuError) -> Self {
        Self::Device(error)
    }
}

impl<'s> Session<'s> {
    /// Begins a run by `plan`, at means of neighbors if sweeps cannot open extremely flat triangles at the given positions,
    /// or where the checkpoint was saved.
    pub(crate) async fn new(
        spec: Spec<'s>,
        mut plan: Plan,
        place: Place<'s>,
        mut field: Option<TargetFieldStage<'s>>,
        mut checkpointer: Checkpointer<'s>,
    ) -> Result<Self, SmoothError> {
        let Spec { options, from, resumed, .. } = spec;
        let mut problem = with_local_maps(&spec, from).await;
        // Bounds hold from the given positions on, and plain sweeps are a sequence that the caller determines.
        let may_begin_elsewhere = field.is_none() && !problem.is_bounded() && spec.curves.is_none();
        let relief = match options.is_multilevel() && may_begin_elsewhere {
            true => relieved(spec.problem, &problem, &plan, from).await?,
            false => None,
        };
        let (mut from, given) = match relief {
            Some(Relief { positions, given }) => (Cow::Owned(positions), Some(given)),
            None => (Cow::Borrowed(from), None),
        };
        if given.is_some() {
            problem = with_local_maps(&spec, &from).await;
        }
        let (place, opened) = match resumed {
            Some(checkpoint) => {
                (place.of_checkpoint(&problem, checkpoint), checkpoint.about.opened.clone())
            }
            None => place.at_start(spec.problem, &problem, &plan, &from).await?,
        };
        if let Some(opened) = &opened {
            plan.stop.max_sweeps = plan.stop.max_sweeps.saturating_sub(opened.sweeps());
            from = Cow::Owned(paced::copied(&opened.positions).await);
        }
        let curves = spec.curves.cloned();
        let mut last = Point { problem, log: Vec::new(), positions: from, curves: curves.clone() };
        if let Some(field) = &mut field {
            last.begin_field(field, &plan, resumed).await?;
        }
        checkpointer.last = resumed.map(|resumed| resumed.saved.clone());
        if let Some(about) = &mut checkpointer.about {
            about.opened.clone_from(&opened);
            let before = resumed.and_then(|resumed| resumed.about.on_cpu_from);
            about.on_cpu_from = place.unfit_from().or(before);
        }
        Ok(Self {
            spec,
            place,
            engine: None,
            course: Course::new(&last.problem, &plan, options, field.is_some()),
            history: History::resumed(&plan, &last.log, None),
            plan,
            field,
            batch: 1,
            last,
            curves,
            given,
            opened,
            checkpointer,
        })
    }

    /// Leaves the engine. The next sweep is on a new engine, from the last saved state, or else from the point of return.
    fn restart(&mut self) {
        let Self { last, plan, spec, .. } = self;
        self.engine = None;
        self.course = Course::new(&last.problem, plan, spec.options, self.field.is_some());
        self.history = History::resumed(plan, &last.log, None);
        self.batch = 1;
        if let Some(about) = &mut self.checkpointer.about {
            about.on_cpu_from = self.place.unfit_from().or(about.on_cpu_from);
        }
    }

    /// Returns the layout of the mesh, with the present targets.
    pub(super) fn problem(&self) -> &Problem {
        &self.last.problem
    }

    /// Returns the number of sweeps that opened triangles for the device.
    pub(super) fn opening_sweeps(&self) -> u32 {
        self.opened.as_ref().map_or(0, DoublePrelude::sweeps)
    }

    /// Sweeps until the run has done `until` sweeps, or ends before. Returns the best positions, and the reason if the
    /// run ends.
    pub(super) async fn sweep(
        &mut self,
        until: u32,
        observe: &mut dyn Observer,
    ) -> Result<(Vec<DVec2>, Option<Stop>), SmoothError> {
        loop {
            match self.try_to_sweep(until, observe).await {
                Ok(done) => return Ok(done),
                Err(Failure::Device(error)) => self.fall_back(error)?,
                Err(Failure::NotFinite { sweep }) => {
                    if self.fall_back(GpuError::NotFinite { sweep }).is_err() {
                        return Ok((self.undone().await, Some(Stop::NotFinite)));
                    }
                }
                Err(Failure::LeftOut(error)) => return Err(error.into()),
                Err(Failure::Foreign) => return Err(resume::foreign()),
            }
        }
    }

    /// Sweeps as [`sweep`](Self::sweep) does, on one engine.
    async fn try_to_sweep(
        &mut self,
        until: u32,
        observe: &mut dyn Observer,
    ) -> Result<(Vec<DVec2>, Option<Stop>), Failure> {
        let mut engine = match self.engine.take() {
            Some(engine) => engine,
            None => self.begun_engine().await?,
        };
        let stop = self.advance(&mut engine, until, observe).await?;
        let positions = engine.best_positions().await?;
        self.curves = engine.best_curves().await?;
        self.engine = Some(engine);
        Ok((positions, stop))
    }

    /// Creates an engine in the last saved state, or else at the point of return.
    async fn begun_engine(&mut self) -> Result<AnyEngine<'s>, Failure> {
        let Self { plan, course, last, .. } = self;
        let Point { problem, positions, curves, .. } = last;
        let mut engine = match &self.place {
            Place::Cpu(_) => AnyEngine::Cpu(Box::new(CpuEngine::new(
                problem,
                paced::copied(positions).await,
                curves.clone(),
                plan,
            ))),
            Place::Device(device) => {
                let is_judged_by_host = course.is_judged_by_host() || self.field.is_some();
                let judged = if is_judged_by_host { plan.clone().endless() } else { plan.clone() };
                let work = course.work(plan);
                let curves = curves.as_ref();
                AnyEngine::Device(device.engine(problem, positions, curves, judged, work).await?)
            }
        };
        if let Some(Saved { log, remaining, control, engine: state }) = &self.checkpointer.last {
            self.history = History::resumed(plan, log, *remaining);
            let is_finite = !log.is_empty() && self.history.first_not_finite(0).is_none();
            let has_levels = !state.roots.is_empty();
            let fits = course.restore(control, &mut engine, &mut self.history, has_levels)?;
            if !(fits && is_finite && engine.restore(state).await?) {
                return Err(Failure::Foreign);
            }
        }
        Ok(engine)
    }

    /// Sweeps in batches, and calls the observer after each batch. Returns the reason if the run ends, and `None` after
    /// `until` sweeps.
    async fn advance(
        &mut self,
        engine: &mut AnyEngine<'s>,
        until: u32,
        observe: &mut dyn Observer,
    ) -> Result<Option<Stop>, Failure> {
        let done = self.opening_sweeps();
        let Self { spec, plan, course, history, field, batch, checkpointer, .. } = self;
        // A device without room for the coarser levels is an error if the method requires them.
        let requires_levels = spec.options.method == Method::Multilevel;
        loop {
            let left = until - history.sweeps().min(until);
            if left == 0 && !history.is_empty() {
                return Ok(None);
            }
            let (start, known) = (Instant::now(), history.f().len());
            let sweeps = (*batch).min(left);
            let now =
                Progress { phase: spec.phase, sweep: done + history.sweeps(), f: history.last() };
            let policy: Option<&mut dyn CheckpointPolicy> = match checkpointer.about {
                Some(_) => Some(&mut *checkpointer.policy),
                None => None,
            };
            #[cfg_attr(target_family = "wasm", expect(unused_mut))]
            let mut patience = Patience::new(now, observe, policy);
            #[cfg(not(target_family = "wasm"))]
            let mut goes_on = || patience.goes_on();
            // The observers of browsers are not `Send`, and futures of engines are.
            #[cfg(target_family = "wasm")]
            let mut goes_on = || true;
            course.advance(engine, plan, history, sweeps, &mut goes_on).await?;
            let (has_ended, is_canceled) = (patience.has_ended(), patience.is_canceled());
            *batch = next_batch(sweeps.max(1), start.elapsed());
            if let Some(sweep) = history.first_not_finite(known) {
                return Err(Failure::NotFinite { sweep: done + sweep });
            }
            if let Some(error) = course.left_out().filter(|_| requires_levels) {
                return Err(Failure::LeftOut(error.clone()));
            }
            if is_canceled {
                return Ok(Some(Stop::Canceled));
            }
            if let Some(stop) = history.stop() {
                return Ok(Some(stop));
            }
            let (sweep, f) = (done + history.sweeps(), history.last());
            let is_ending =
                has_ended || observe(&Progress { phase: spec.phase, sweep, f }).is_break();
            let period = || field.as_ref().map(TargetFieldStage::save);
            checkpointer.after_sweeps(engine, history, || course.save(), period, is_ending).await?;
            if is_ending {
                return Ok(Some(Stop::Canceled));
            }
        }
    }

    /// Leaves a device that has failed, so that the run continues on the CPU. Returns the error if the run has no device,
    /// or if the policy refuses.
    fn fall_back(&mut self, error: GpuError) -> Result<(), SmoothError> {
        let Self { last, checkpointer, .. } = self;
        let at_return = (last.log.len() as u32).saturating_sub(1);
        let sweep = checkpointer.last.as_ref().map_or(at_return, Saved::sweeps);
        let sweep = sweep + self.opened.as_ref().map_or(0, DoublePrelude::sweeps);
        self.place = self.place.clone().after_failure(error, sweep, checkpointer.policy)?;
        self.restart();
        Ok(())
    }

    /// Returns to the last saved state, or to the point of return, because a later sweep made f infinite or NaN. Returns the
    /// positions of this state.
    async fn undone(&mut self) -> Vec<DVec2> {
        let Self { last, plan, .. } = self;
        // Sweeps after the last period may have moved vertices to where f by the field is larger.
        let saved = self.checkpointer.last.take().filter(|_| self.field.is_none());
        if let Some(Saved { log, engine, .. }) = saved {
            let best = last.curves.as_mut().and_then(|curves| curves.restore(&engine)).flatten();
            if let (Some(curves), Some(best)) = (&mut last.curves, best) {
                curves.set_params(&best);
            }
            last.log = log;
            last.positions = engine.best.unwrap_or(engine.positions).into();
        }
        if last.log.is_empty() {
            last.log = vec![objectives(&plan.tracked(), &last.problem, &last.positions).await];
        }
        self.curves.clone_from(&last.curves);
        let positions = last.positions.to_vec();
        self.restart();
        positions
    }

    /// Ends a period of a target field: its stage moves the vertices to `swept`, or back toward their positions before the
    /// period, and sets the targets there. The engine continues from the new state, which becomes the point of return.
    /// Returns the positions and the decision whether the run ends; `None` without a target field.
    pub(super) async fn follow_field(
        &mut self,
        swept: &[DVec2],
    ) -> Result<Option<(Vec<DVec2>, Judgment)>, SmoothError> {
        let Self { last, plan, history, course, field: Some(field), .. } = self else {
            return Ok(None);
        };
        let positions = field.work(&mut last.problem, plan, swept).await?;
        let now = objectives(&plan.tracked(), &last.problem, &positions).await;
        // Lower objectives of sweeps by the former targets no longer count.
        history.replace_after(field.began(), now);
        history.end(None, history.remaining());
        let (sweeps, f) = (history.sweeps(), history.last());
        course.disturbed(f);
        let judged = field.judge(f, sweeps >= plan.stop.max_sweeps);
        field.begin_period(sweeps, positions.clone(), f);
        // The state that was saved before belongs to other positions and targets.
        self.checkpointer.last = None;
        last.log = history.log().to_vec();
        last.positions = positions.clone().into();
        last.curves.clone_from(&self.curves);
        let is_moved = positions != swept;
        if let Err(error) = self.send(&positions, is_moved) {
            self.fall_back(error)?;
        }
        if is_moved && self.place.device().is_some() {
            self.place = self.place.clone().after_move(self.problem(), &positions, sweeps).await;
            if self.place.device().is_none() {
                self.restart();
            }
        }
        Ok(Some((positions, judged)))
    }

    /// Sends the targets of the point of return to the engine, and the positions if `is_moved`.
    fn send(&mut self, positions: &[DVec2], is_moved: bool) -> Result<(), GpuError> {
        let Some(engine) = &mut self.engine else { return Ok(()) };
        let mut problem = self.last.problem.clone();
        problem.share_maps_of_levels(engine.problem());
        engine.set_maps(&problem)?;
        if is_moved { engine.set_positions(positions) } else { Ok(()) }
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

/// Returns the next number of sweeps, such that the observer is called about ten times a second. The number does not
/// affect the result.
fn next_batch(batch: u32, took: Duration) -> u32 {
    let fits = 0.1 * f64::from(batch) / took.as_secs_f64().max(1e-6);
    (fits as u32).clamp(1, 4 * batch).min(100)
}
