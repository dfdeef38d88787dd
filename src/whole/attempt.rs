//! One run from some positions to its end, on the engines that it needs.

use std::cmp::Ordering;

use glam::DVec2;

use crate::cpu::{CpuEngine, held_back, mean_excess};
use crate::error::{GpuError, SmoothError};
use crate::layout::Problem;
use crate::metric::Metric;
use crate::outcome::DeviceFault;
use crate::resume;
use crate::run::opening::{self, Obstacle, Opened};
use crate::run::{
    CPU, Checkpoint, Course, DriveError, End, Guard, History, Keeper, Keeping, Method, Objectives,
    Observer, Options, Phase, Plan, Progress, Saved, Stop, Strategy, drive, set_guards,
};
use crate::whole::device::Device;
use crate::whole::in_rounds::objectives;

/// The largest sum of q² - ideal² that a device is given. It is far below the largest single, 3e38, as formulas of
/// metrics of size multiply powers of their arguments.
const MOST_ON_DEVICE: f64 = 1e15;

/// The part of a run between two rounds of other work.
pub(crate) struct Round<'a> {
    pub(crate) options: &'a Options,
    pub(crate) plan: &'a Plan,
    /// The value of f at which the run ends; `None` for a run without a goal.
    pub(crate) target: Option<f64>,
}

/// One run, on the CPU or a device: the smoothing itself, or a search for the desired objective.
pub(crate) struct Attempt<'s> {
    pub(crate) problem: &'s Problem,
    pub(crate) device: Option<Device<'s>>,
    pub(crate) phase: Phase,
    /// Number of sweeps before this attempt, to be added in reports to the observer.
    pub(crate) done: u32,
}

/// The end of an [`Attempt`], including the sweeps that opened flat triangles.
pub(crate) struct Ended {
    pub(crate) history: Vec<Objectives>,
    pub(crate) positions: Vec<DVec2>,
    pub(crate) alternated: u32,
    pub(crate) corrections: u32,
    pub(crate) opening_sweeps: u32,
    pub(crate) levels_left_out: bool,
    pub(crate) remaining: Option<f64>,
    pub(crate) held_back: usize,
    pub(crate) stop: Stop,
    pub(crate) fault: Option<DeviceFault>,
}

impl Ended {
    /// Combines this end with that of a run which continued from it.
    pub(crate) fn followed_by(self, next: Ended) -> Ended {
        let mut history = self.history;
        // The first entry is for the positions at which this run ended.
        history.extend(next.history.into_iter().skip(1));
        Ended {
            history,
            // Only runs by one metric are continued by others.
            alternated: self.alternated + next.alternated,
            corrections: self.corrections + next.corrections,
            opening_sweeps: self.opening_sweeps + next.opening_sweeps,
            levels_left_out: self.levels_left_out || next.levels_left_out,
            fault: self.fault.or(next.fault),
            ..next
        }
    }
}

impl Attempt<'_> {
    /// Sweeps from some positions, or from a checkpoint of a run that began there, until the run ends.
    pub(crate) async fn sweep<K: Keeper + ?Sized>(
        &self,
        options: &Options,
        target: Option<f64>,
        from: &[DVec2],
        resumed: Option<&Checkpoint>,
        keeping: &mut Keeping<'_, K>,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Ended, SmoothError> {
        let problem = self.problem;
        let mut plan = options.plan_to(target);
        if problem.free_count() == 0 {
            return Ok(self.still(&plan, from, observe));
        }
        set_guards(&mut plan, options.guard, problem, from);
        let (device, opened) = match resumed {
            Some(Checkpoint { about, saved }) => {
                (self.device.filter(|_| saved.engine.engine != CPU), about.opened.clone())
            }
            None => self.opened(&plan, from).await?,
        };
        if let Some(about) = &mut keeping.about {
            about.opened.clone_from(&opened);
        }
        let done = opened.as_ref().map_or(0, Opened::sweeps);
        plan.stop.max_sweeps = plan.stop.max_sweeps.saturating_sub(done);
        let from = opened.as_ref().map_or(from, |opened| &opened.positions);
        let corrected = options.is_multilevel();
        let must = options.method == Method::Multilevel;
        keeping.last = resumed.map(|resumed| resumed.saved.clone());
        let (mut place, mut fault) = (device, None);
        let end = loop {
            let last = keeping.last.clone();
            let course =
                Course { plan: &plan, must, phase: self.phase, done: self.done + done, from: last };
            let strategy = Strategy::new(problem, &plan, corrected);
            let driven = match place {
                None => {
                    let engine = CpuEngine::new(problem, from.to_vec(), &plan);
                    drive(engine, course, strategy, keeping, observe).await
                }
                Some(device) => {
                    let steps = Strategy::steps(&plan, corrected);
                    // The host judges a run with corrections, so the device must not end it.
                    let judged = if corrected { plan.clone().endless() } else { plan.clone() };
                    match device.engine(problem, from, judged, steps) {
                        Ok(engine) => drive(engine, course, strategy, keeping, observe).await,
                        Err(error) => Err(error.into()),
                    }
                }
            };
            let error = match driven {
                Ok(end) => break end,
                Err(DriveError::Device(error)) => error,
                Err(DriveError::NotFinite { sweep }) => GpuError::NotFinite { sweep },
                Err(DriveError::LeftOut(error)) => return Err(error.into()),
                Err(DriveError::Foreign) => return Err(resume::foreign()),
            };
            let kept = keeping.last.as_ref().map_or(0, Saved::sweeps) + self.done + done;
            if place.is_some() && keeping.keeper.goes_on_without(&error, kept) {
                (place, fault) = (None, Some(DeviceFault { sweep: kept, error }));
            } else if matches!(error, GpuError::NotFinite { .. }) {
                break self.undone(&plan, from, keeping.last.take());
            } else {
                return Err(error.into());
            }
        };
        let remaining = end.history.remaining();
        let mut stop = end.stop;
        let mut held = 0;
        let step = plan.base_step(1.0);
        if matches!(stop, Stop::Converged | Stop::MaxSweeps) && step.shape_guard.is_finite() {
            held = held_back(problem, &end.positions, &step);
            if held > 0 && options.guard == Guard::ByMetric && stop == Stop::Converged {
                stop = Stop::HeldBack;
            }
        }
        let (history, positions) = match opened {
            Some(opened) => opened.followed_by(end.history, end.positions),
            None => (end.history.into_log(), end.positions),
        };
        let opening_sweeps = match (self.device, device) {
            (Some(_), None) if resumed.is_none() => history.len() as u32 - 1,
            _ => done,
        };
        Ok(Ended {
            history,
            positions,
            alternated: done + end.alternated,
            corrections: end.corrections,
            opening_sweeps,
            levels_left_out: end.levels_left_out,
            remaining,
            held_back: held,
            stop,
            fault,
        })
    }

    /// Returns the end of a run in which no vertex is free. Its sweeps change nothing.
    fn still(&self, plan: &Plan, from: &[DVec2], observe: &mut (impl Observer + ?Sized)) -> Ended {
        let sweeps = plan.stop.max_sweeps;
        let here = objectives(self.problem, plan, from);
        let f = here.of(plan.scheme.base()).unwrap_or(f64::NAN);
        let progress = Progress { phase: self.phase, sweep: self.done + sweeps, f };
        let is_left = observe(&progress).is_break();
        Ended {
            history: vec![here; sweeps as usize + 1],
            positions: from.to_vec(),
            alternated: sweeps,
            corrections: 0,
            opening_sweeps: 0,
            levels_left_out: false,
            remaining: None,
            held_back: 0,
            stop: if is_left { Stop::Canceled } else { Stop::MaxSweeps },
            fault: None,
        }
    }

    /// Returns the end of a run in the state that was last saved, or at its start, because a later sweep made f
    /// infinite or NaN.
    fn undone(&self, plan: &Plan, from: &[DVec2], last: Option<Saved>) -> End {
        let (log, positions) = match last {
            Some(Saved { log, engine, .. }) => (log, engine.best.unwrap_or(engine.positions)),
            None => (vec![objectives(self.problem, plan, from)], from.to_vec()),
        };
        let history = History::resumed(plan, &log, None);
        let (stop, corrections, alternated) = (Stop::NotFinite, 0, history.sweeps());
        End { history, positions, alternated, corrections, levels_left_out: false, stop }
    }

    /// Opens triangles that are too flat for a device, by sweeps on the CPU. Returns the device that continues, and
    /// these sweeps, if there were any. If they do not open every triangle, or triangles are too small for a device, no
    /// device is returned, and the whole run is done on the CPU.
    async fn opened(
        &self,
        plan: &Plan,
        from: &[DVec2],
    ) -> Result<(Option<Device<'_>>, Option<Opened>), SmoothError> {
        if self.device.is_none() {
            return Ok((None, None));
        }
        // If sizes differ very much, the sums of some metrics exceed the range of single precision.
        let sum = |metric: &Metric| {
            mean_excess(*metric, self.problem, from) * self.problem.triangles().len() as f64
        };
        let is_huge = |metric: &Metric| {
            let is_ratio = metric.properties().is_inverse_mean_ratio;
            // A sum that is NaN counts as too large.
            !is_ratio && sum(metric).partial_cmp(&MOST_ON_DEVICE) != Some(Ordering::Less)
        };
        if plan.tracked().iter().chain(plan.scheme.metrics()).any(is_huge) {
            return Ok((None, None));
        }
        match opening::obstacle(self.problem, from) {
            Obstacle::None => return Ok((self.device, None)),
            Obstacle::Flat => {}
            Obstacle::Small => return Ok((None, None)),
        }
        let engine = CpuEngine::new(self.problem, from.to_vec(), plan);
        Ok(match opening::open(self.problem, engine, plan).await? {
            Some(opened) => (self.device, Some(opened)),
            None => (None, None),
        })
    }
}
