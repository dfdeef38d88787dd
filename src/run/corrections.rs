//! Runs whose sweeps are corrected from coarser levels.

use crate::error::GpuError;
use crate::layout::Problem;
use crate::metric::{Metric, Stiffness};
use crate::run::engine::{Engine, Proposal};
use crate::run::history::History;
use crate::run::multilevel::{Hierarchy, Search};
use crate::run::objectives::Objectives;
use crate::run::plan::Plan;
use crate::run::step::Step;
use crate::run::stop::StopRule;
use crate::run::yielding::yield_now;

/// Corrections begin when a sweep alone takes less than this share off what f has above its ideal
/// value: before, a few bad triangles would hold every correction back.
const SWEEPS_PAY: f64 = 0.1;
/// Over-relaxation of sweeps before the corrections, but for the first, and of those between them.
/// Measured from strongly perturbed and smoothly distorted starts of 2,000 to a million vertices.
const OMEGA_BEFORE: f64 = 1.5;
const OMEGA_BETWEEN: f64 = 1.3;
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

/// Sweeps with corrections from coarser levels: what comes next, and what has become of the corrections so far.
pub(crate) struct Corrections<'a> {
    problem: &'a Problem,
    plan: &'a Plan,
    stiffness: Stiffness,
    stage: Stage,
    /// How often corrections began.
    attempts: u32,
    taken: u32,
    /// Why there are no corrections, if the levels do not fit.
    left_out: Option<GpuError>,
}

#[derive(Clone, Copy)]
enum Stage {
    /// Sweeps alone, as long as they pay and to this one at least.
    Before { until: usize },
    /// Each sweep is followed by a correction.
    Correcting { since: usize, length: f64, proposed: u32, refused: u32 },
    /// Sweeps alone, as no correction helps.
    Without { since: usize },
}

impl<'a> Corrections<'a> {
    /// None taken yet. Of the plan, the base metric and the stop rule count; that metric has a stiffness.
    pub(crate) fn new(problem: &'a Problem, plan: &'a Plan) -> Self {
        let properties = plan.scheme.base().properties();
        Self {
            problem,
            plan,
            stiffness: properties.stiffness.unwrap_or(Stiffness::Uniform(1.0)),
            stage: Stage::Before { until: 1 },
            attempts: 0,
            taken: 0,
            left_out: None,
        }
    }

    /// Every different step that a run takes.
    pub(crate) fn steps(plan: &Plan) -> Vec<Step> {
        let own = plan.scheme.base().properties().omega;
        [1.0, OMEGA_BEFORE, OMEGA_BETWEEN, own].map(|omega| plan.base_step(omega)).to_vec()
    }

    /// Does up to `sweeps` further sweeps; fewer when the run stops.
    pub(crate) async fn advance(
        &mut self,
        engine: &mut impl Engine,
        history: &mut History,
        sweeps: u32,
    ) -> Result<(), GpuError> {
        if history.is_empty() {
            let start = engine.objectives().await?;
            self.record(start, history);
        }
        for _ in 0..sweeps {
            if history.stop().is_some() {
                break;
            }
            let objectives = match self.stage {
                Stage::Before { until } => self.sweep_before(engine, history, until).await?,
                Stage::Correcting { since, length, proposed, refused } => {
                    let state = (since, length, proposed, refused);
                    self.sweep_and_correct(engine, history, state).await?
                }
                Stage::Without { .. } => self.sweep_without(engine).await?,
            };
            self.record(objectives, history);
        }
        Ok(())
    }

    /// Corrections taken so far.
    pub(crate) fn taken(&self) -> u32 {
        self.taken
    }

    /// Why the run does without corrections, if the place where the mesh is does not hold the levels below it.
    pub(crate) fn left_out(&self) -> Option<&GpuError> {
        self.left_out.as_ref()
    }

    fn metric(&self) -> Metric {
        self.plan.scheme.base()
    }

    async fn sweep_before(
        &mut self,
        engine: &mut impl Engine,
        history: &History,
        until: usize,
    ) -> Result<Objectives, GpuError> {
        let done = history.f().len();
        let omega = if done == 1 { 1.0 } else { OMEGA_BEFORE };
        engine.sweep(&self.plan.base_step(omega)).await?;
        let objectives = engine.objectives().await?;
        let last = self.excess(history, done - 1);
        let now = objectives.of(self.metric()).unwrap_or(f64::NAN) - self.metric().ideal_squared();
        if done >= until && last - now < SWEEPS_PAY * last {
            self.attempts += 1;
            self.stage = Stage::Correcting { since: done, length: 1.0, proposed: 0, refused: 0 };
        }
        Ok(objectives)
    }

    async fn sweep_without(&self, engine: &mut impl Engine) -> Result<Objectives, GpuError> {
        let own = self.metric().properties().omega;
        engine.sweep(&self.plan.base_step(own)).await?;
        engine.objectives().await
    }

    /// Builds the levels, or fits them to new sizes, and hands them to the engine. Says whether it holds them.
    async fn build_levels(
        &mut self,
        engine: &mut impl Engine,
        proposed: u32,
    ) -> Result<bool, GpuError> {
        yield_now().await;
        // What does not serve any more goes first.
        let before = engine.take_hierarchy().filter(|_| proposed > 0);
        let positions = engine.positions().await?;
        let hierarchy = match before {
            Some(before) => before.resized(self.problem, &positions, self.stiffness),
            None => Hierarchy::new(self.problem, &positions, self.stiffness),
        };
        drop(positions);
        yield_now().await;
        match engine.set_hierarchy(hierarchy) {
            Err(error @ GpuError::Limit { .. }) => {
                self.left_out = Some(error);
                Ok(false)
            }
            set => set.map(|()| true),
        }
    }

    async fn sweep_and_correct(
        &mut self,
        engine: &mut impl Engine,
        history: &History,
        (since, last_length, proposed, refused): (usize, f64, u32, u32),
    ) -> Result<Objectives, GpuError> {
        let done = history.f().len();
        let built = self.excess(history, since);
        let lost = built - self.excess(history, done - 1);
        if (proposed == 0 || proposed == RESIZE_AFTER && lost > RESIZE_IF * built)
            && !self.build_levels(engine, proposed).await?
        {
            self.stage = Stage::Without { since: done };
            return self.sweep_without(engine).await;
        }
        let mut length = Search::first_length(last_length);
        let step = self.plan.base_step(OMEGA_BETWEEN);
        let Proposal { here, slope, there } = engine.propose(&step, length).await?;
        let mut search = Search::new(here, slope);
        if slope < 0.0 {
            let mut next = search.tried(length, there);
            while let Some(another) = next {
                length = another;
                next = search.tried(length, engine.excess_along(length).await?);
            }
        }
        let (excess, length, refused) = match search.best() {
            Some((length, there)) => {
                engine.move_along(length).await?;
                self.taken += 1;
                (there, length, if length < SHORT { refused + 1 } else { 0 })
            }
            None => (here, last_length, refused + 1),
        };
        self.stage = match refused {
            MOST_REFUSED if self.attempts == ATTEMPTS => Stage::Without { since: done },
            MOST_REFUSED => Stage::Before { until: done + SWEEPS_BETWEEN },
            _ => Stage::Correcting { since, length, proposed: proposed + 1, refused },
        };
        if self.plan.track_all {
            return engine.objectives().await;
        }
        let mut objectives = Objectives::untracked();
        objectives.set(self.metric(), self.metric().ideal_squared() + excess);
        Ok(objectives)
    }

    /// The base objective above its ideal value.
    fn excess(&self, history: &History, evaluation: usize) -> f64 {
        history.f()[evaluation] - self.metric().ideal_squared()
    }

    fn record(&self, objectives: Objectives, history: &mut History) {
        history.add(objectives);
        // The decay is extrapolated from what the present stage has done alone. Corrected sweeps leave no slow
        // mode behind that only a longer window would see.
        let (since, window) = match self.stage {
            Stage::Before { .. } => (0, NO_ESTIMATE),
            // A step that failed gains little, and says nothing on what is left.
            Stage::Correcting { since, refused: 1.., .. } => (since, NO_ESTIMATE),
            Stage::Correcting { since, .. } => (since, 1),
            Stage::Without { since } => (since, StopRule::window(&self.metric().into()) as usize),
        };
        let of_stage = &history.f()[since..];
        let rule = history.rule();
        let rule = StopRule { max_sweeps: rule.max_sweeps.saturating_sub(since as u32), ..rule };
        let stop = rule.judge(of_stage, of_stage.len() - 1, window);
        let remaining = rule.remaining(of_stage, window);
        history.end(stop, remaining);
    }
}
