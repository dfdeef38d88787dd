//! A multilevel run, wherever the mesh itself is.

use glam::DVec2;
use std::borrow::Cow;

use super::hierarchy::Hierarchy;
use super::search::Search;
use crate::error::GpuError;
use crate::layout::Problem;
use crate::metric::{Metric, Stiffness};
use crate::run::Objectives;
use crate::run::{Plan, Stop, StopRule};

/// Corrections begin when a sweep alone takes less than this share off what f has above its ideal
/// value: before, a few bad triangles would hold every correction back.
const SWEEPS_PAY: f64 = 0.1;
/// Over-relaxation of sweeps before the corrections, but for the first, and of those between them.
/// Measured from strongly perturbed and smoothly distorted starts of 2,000 to a million vertices.
const OMEGA_BEFORE: f64 = 1.5;
const OMEGA_BETWEEN: f64 = 1.3;
/// Every over-relaxation a run uses beside 1 and the metric's own.
pub(crate) const OMEGAS: [f64; 2] = [OMEGA_BEFORE, OMEGA_BETWEEN];
/// The hierarchy is fitted to the sizes of elements again after this many corrections, once, if meanwhile f has
/// lost more than the share below of what it had above its ideal: then they have changed.
const RESIZE_AFTER: u32 = 2;
const RESIZE_IF: f64 = 0.15;
/// A correction taken at a shorter length than this helps no more than one refused,
const SHORT: f64 = 0.05;
/// and after so many of them in a row there are sweeps alone again, this many at least,
const MOST_REFUSED: u32 = 2;
const SWEEPS_BETWEEN: usize = 5;
/// and after so many attempts for good.
const ATTEMPTS: u32 = 5;

/// A window no history fills: the run is then not judged by its decay.
const NO_ESTIMATE: usize = 1 << 30;

/// The mesh itself: what a multilevel run asks of the place where it is.
///
/// Objectives are mean excesses: f less the metric's ideal value squared.
pub(crate) trait FineLevel {
    /// The objectives now, of all tracked metrics.
    async fn objectives(&mut self) -> Result<Objectives, GpuError>;

    /// One sweep.
    async fn sweep(&mut self, omega: f64) -> Result<(), GpuError>;

    /// Normalized positions of all vertices.
    async fn positions(&mut self) -> Result<Cow<'_, [DVec2]>, GpuError>;

    /// Gives back the levels it was given, if any.
    fn hierarchy(&mut self) -> Option<Hierarchy>;

    /// Takes the levels below, or [`GpuError::Limit`] if there is no room for them: the run then goes on without.
    fn set_hierarchy(&mut self, hierarchy: Hierarchy) -> Result<(), GpuError>;

    /// One sweep, then the correction from the levels below, tried at `length`.
    async fn propose(&mut self, omega: f64, length: f64) -> Result<Proposal, GpuError>;

    /// The objective with all free vertices moved `length` times along the correction; `None` if a
    /// triangle is inverted there.
    async fn objective_along(&mut self, length: f64) -> Result<Option<f64>, GpuError>;

    /// Moves them there.
    async fn take(&mut self, length: f64) -> Result<(), GpuError>;
}

/// A correction, before it is taken.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Proposal {
    /// The objective without it.
    pub(crate) here: f64,
    /// Its derivative along the correction.
    pub(crate) slope: f64,
    /// The objective at the length asked for; `None` if a triangle is inverted there.
    pub(crate) there: Option<f64>,
}

/// A run of sweeps with corrections from coarser levels.
pub(crate) struct MultilevelEngine<'a, F> {
    problem: &'a Problem,
    fine: F,
    metric: Metric,
    stiffness: Stiffness,
    rule: StopRule,
    track_all: bool,
    /// Over-relaxation if corrections come to nothing.
    omega: f64,
    phase: Phase,
    /// How often corrections began.
    attempts: u32,
    history: Vec<f64>,
    corrections: u32,
    /// Why there are no corrections, if the levels do not fit.
    left_out: Option<GpuError>,
    stop: Option<Stop>,
}

#[derive(Clone, Copy)]
enum Phase {
    /// Sweeps alone, as long as they pay and to this one at least.
    Before { until: usize },
    /// Each sweep is followed by a correction.
    Correcting { since: usize, length: f64, proposed: u32, refused: u32 },
    /// Sweeps alone, as no correction helps.
    Without { since: usize },
}

impl<'a, F: FineLevel> MultilevelEngine<'a, F> {
    /// Starts a run on `fine`, which has the problem's mesh. Of the plan, the base metric and the stop rule
    /// count; that metric has a stiffness.
    pub(crate) fn new(problem: &'a Problem, fine: F, plan: &Plan) -> Self {
        let metric = plan.scheme.base();
        Self {
            problem,
            fine,
            metric,
            stiffness: metric.properties().stiffness.unwrap_or(Stiffness::Uniform(1.0)),
            rule: plan.stop,
            track_all: plan.track_all,
            omega: metric.properties().omega,
            phase: Phase::Before { until: 1 },
            attempts: 0,
            history: Vec::new(),
            corrections: 0,
            left_out: None,
            stop: None,
        }
    }

    /// As [`Engine::advance`](crate::Engine::advance).
    pub(crate) async fn advance(&mut self, sweeps: u32) -> Result<Vec<Objectives>, GpuError> {
        let mut log = Vec::new();
        if self.history.is_empty() {
            let start = self.fine.objectives().await?;
            self.record(start, &mut log);
        }
        for _ in 0..sweeps {
            if self.stop.is_some() {
                break;
            }
            let objectives = match self.phase {
                Phase::Before { until } => self.sweep_before(until).await?,
                Phase::Correcting { since, length, proposed, refused } => {
                    self.sweep_and_correct(since, length, proposed, refused).await?
                }
                Phase::Without { .. } => self.sweep_without().await?,
            };
            self.record(objectives, &mut log);
        }
        Ok(log)
    }

    /// Why the run has ended, if it has.
    pub(crate) fn stop(&self) -> Option<Stop> {
        self.stop
    }

    /// Corrections taken so far.
    pub(crate) fn corrections(&self) -> u32 {
        self.corrections
    }

    /// Why the run does without corrections, if the place where the mesh is does not hold the levels below it.
    pub(crate) fn left_out(&self) -> Option<&GpuError> {
        self.left_out.as_ref()
    }

    /// As [`Engine::best_positions`](crate::Engine::best_positions): no step raises the objective.
    pub(crate) async fn best_positions(&mut self) -> Result<Vec<DVec2>, GpuError> {
        Ok(self.fine.positions().await?.into_owned())
    }

    async fn sweep_before(&mut self, until: usize) -> Result<Objectives, GpuError> {
        let done = self.history.len();
        self.fine.sweep(if done == 1 { 1.0 } else { OMEGA_BEFORE }).await?;
        let objectives = self.fine.objectives().await?;
        let last = self.excess(done - 1);
        let now = objectives.of(self.metric).unwrap_or(f64::NAN) - self.metric.ideal_squared();
        if done >= until && last - now < SWEEPS_PAY * last {
            self.attempts += 1;
            self.phase = Phase::Correcting { since: done, length: 1.0, proposed: 0, refused: 0 };
        }
        Ok(objectives)
    }

    async fn sweep_without(&mut self) -> Result<Objectives, GpuError> {
        self.fine.sweep(self.omega).await?;
        self.fine.objectives().await
    }

    async fn sweep_and_correct(
        &mut self,
        since: usize,
        last_length: f64,
        proposed: u32,
        refused: u32,
    ) -> Result<Objectives, GpuError> {
        let built = self.excess(since);
        let lost = built - self.excess(self.history.len() - 1);
        if proposed == 0 || proposed == RESIZE_AFTER && lost > RESIZE_IF * built {
            // What does not serve any more goes first.
            let before = self.fine.hierarchy().filter(|_| proposed > 0);
            let positions = self.fine.positions().await?;
            let hierarchy = match before {
                Some(before) => before.resized(self.problem, &positions, self.stiffness),
                None => Hierarchy::new(self.problem, &positions, self.stiffness),
            };
            drop(positions);
            match self.fine.set_hierarchy(hierarchy) {
                Err(error @ GpuError::Limit { .. }) => {
                    self.left_out = Some(error);
                    self.phase = Phase::Without { since: self.history.len() };
                    return self.sweep_without().await;
                }
                set => set?,
            }
        }
        let mut length = Search::first_length(last_length);
        let Proposal { here, slope, there } = self.fine.propose(OMEGA_BETWEEN, length).await?;
        let mut search = Search::new(here, slope);
        if slope < 0.0 {
            let mut next = search.tried(length, there);
            while let Some(another) = next {
                length = another;
                next = search.tried(length, self.fine.objective_along(length).await?);
            }
        }
        let (excess, length, refused) = match search.best() {
            Some((length, there)) => {
                self.fine.take(length).await?;
                self.corrections += 1;
                (there, length, if length < SHORT { refused + 1 } else { 0 })
            }
            None => (here, last_length, refused + 1),
        };
        let done = self.history.len();
        self.phase = match refused {
            MOST_REFUSED if self.attempts == ATTEMPTS => Phase::Without { since: done },
            MOST_REFUSED => Phase::Before { until: done + SWEEPS_BETWEEN },
            _ => Phase::Correcting { since, length, proposed: proposed + 1, refused },
        };
        if self.track_all {
            return self.fine.objectives().await;
        }
        let mut objectives = Objectives::untracked();
        objectives.set(self.metric, self.metric.ideal_squared() + excess);
        Ok(objectives)
    }

    /// The base objective above its ideal value.
    fn excess(&self, evaluation: usize) -> f64 {
        self.history[evaluation] - self.metric.ideal_squared()
    }

    fn record(&mut self, objectives: Objectives, log: &mut Vec<Objectives>) {
        self.history.push(objectives.of(self.metric).unwrap_or(f64::NAN));
        log.push(objectives);
        // The decay is extrapolated from what the present phase has done alone. Corrected sweeps leave no slow
        // mode behind that only a longer window would see.
        let (since, window) = match self.phase {
            Phase::Before { .. } => (0, NO_ESTIMATE),
            // A step that failed gains little, and says nothing on what is left.
            Phase::Correcting { since, refused: 1.., .. } => (since, NO_ESTIMATE),
            Phase::Correcting { since, .. } => (since, 1),
            Phase::Without { since } => (since, StopRule::window(&self.metric.into()) as usize),
        };
        let history = &self.history[since..];
        let rule =
            StopRule { max_sweeps: self.rule.max_sweeps.saturating_sub(since as u32), ..self.rule };
        self.stop = rule.judge(history, history.len() - 1, window);
    }
}
