//! Runs with corrections from coarser levels: when corrections begin, pause and end.

mod exponent;
mod levels;
mod plan_steps;
mod reopening;
mod words;

use crate::error::GpuError;
use crate::layout::Problem;
use crate::metric::Metric;
use crate::run::engine::{Engine, Proposal};
use crate::run::history::History;
use crate::run::multilevel::{LEAST_FIRST, Search};
use crate::run::objectives::Objectives;
use crate::run::plan::Plan;
use crate::run::step::Step;
use crate::run::stop::{LEAST_SCALE, NOISE, Stop, StopRule};
use plan_steps::{OMEGA_BEFORE, exponents, reopening_sweep};

/// Corrections begin when a sweep alone lowers the excess of f over its ideal value by less than this share. Earlier,
/// a few bad triangles would force every correction to be short.
const SWEEPS_PAY: f64 = 0.1;
/// After [`MANY_SWEEPS`] sweeps alone, corrections begin by this share instead. On a mesh whose ideal can be reached, each sweep may lower the
/// excess by the same 15 %, for hundreds of sweeps.
const MANY_SWEEPS_PAY: f64 = 0.2;
const MANY_SWEEPS: usize = 12;
/// Over-relaxation of sweeps before corrections begin, if metrics alternate: each metric would have to undo the
/// overshoot of the one before.
const OMEGA_ALTERNATING: f64 = 1.0;
/// Over-relaxation of sweeps that are followed by corrections. Chosen by the same measurements as [`OMEGA_BEFORE`].
pub(crate) const OMEGA_BETWEEN: f64 = 1.3;
/// A correction shorter than this helps so little that it counts as refused, though it is taken. For EDGE lengths are a
/// tenth of the usual ones, as its p-norm is stiffer across its kinks than the levels assume.
const SHORT: f64 = 0.05;
const SHORT_FOR_EDGE: f64 = 0.005;
/// The least length that is tried first for EDGE; see [`LEAST_FIRST`] for other metrics.
const LEAST_FIRST_FOR_EDGE: f64 = 0.1;
/// Number of refused corrections in a row after which the run goes back to sweeps alone.
const MOST_REFUSED: u32 = 2;
/// The least number of sweeps alone before corrections begin again.
const SWEEPS_BETWEEN: usize = 5;
/// The most times that corrections can begin. If they are refused the last time, the run ends with sweeps alone.
const ATTEMPTS: u32 = 5;

/// A run ends if a correction is expected to gain nothing and a sweep gains less than this share of the tolerance.
const SWEPT: f64 = 0.1;

/// A window longer than any history. It turns off the tests of the stop rule that depend on the decay.
const NO_ESTIMATE: usize = 1 << 30;

/// Corrections are accelerated once the slope along one is more than this share of the slope along the one before. On
/// most meshes it falls to a sixth or less each time, and there is nothing to gain.
const ACCELERATED_FROM: f64 = 0.3;

/// Number of estimates in a row that must agree before a run with accelerated corrections ends, as its gains are
/// irregular. One is enough if the last gains were each less than [`STEADY`] times the one before.
const ESTIMATES: usize = 4;
/// As many for EDGE, where they are of a p-norm that is near f by itself.
const ESTIMATES_FOR_EDGE: usize = 2;
const STEADY: f64 = 0.3;
/// Factor on these estimates. Some runs gained half as much each time and were left with modes that the last
/// corrections had not touched. With three estimates and without the factor, 5 of 21 runs from hard starts estimated
/// too little, by up to a third.
const CAUTION: f64 = 1.5;

/// The state of a run with corrections from coarser levels.
pub(crate) struct Corrections<'a> {
    problem: &'a Problem,
    plan: &'a Plan,
    stage: Stage,
    /// Number of times that corrections have begun.
    attempts: u32,
    /// Number of corrections taken.
    taken: u32,
    /// Number of sweeps after which corrections began for the first time; 0 before.
    alternated: u32,
    /// Whether the last correction was expected to gain nothing.
    settled: bool,
    /// The slope along the last correction of the present stage.
    slope: Option<f64>,
    /// log2 of the present exponent of EDGE's p-norm.
    sharpness: u32,
    /// The objective that corrections lower, f or EDGE's p-norm, after each sweep of the present stage. For f it begins
    /// with the value before the stage; that of the p-norm is not known.
    lowered: Vec<f64>,
    /// Whether corrections are accelerated by secant pairs.
    accelerated: bool,
    /// Whether the engine is to forget the pairs that it has. Never so between two sweeps.
    anew: bool,
    /// Whether the engine has levels.
    has_levels: bool,
    /// The indices in the history at which the levels were built, and at which they were last built or fitted.
    built: usize,
    fitted: usize,
    /// The latest estimates of the share of f that is left to gain, infinite if there is none.
    estimates: [f64; ESTIMATES],
    /// The error if there are no corrections, as the engine has no room for the levels.
    left_out: Option<GpuError>,
    /// Whether triangles that lie flat at a low exponent have been reopened after it had doubled, or cannot be.
    was_reopened: bool,
    /// Whether the engine had no room for the levels before the run continued from a saved state.
    was_left_out: bool,
}

/// The stage of corrections.
#[derive(Clone, Copy)]
struct Correcting {
    /// The index in the history at which the stage began.
    since: usize,
    /// The length of the last correction taken.
    length: f64,
    /// The number of corrections tried in this stage.
    proposed: u32,
    /// The number of corrections refused in a row at the end.
    refused: u32,
}

/// The stage of a run. `since` and `until` are indices in the history.
#[derive(Clone, Copy)]
enum Stage {
    /// Sweeps alone, at least up to `until`, and then as long as they gain enough: by the metrics of the scheme in
    /// turn, or by the base metric once corrections have been tried.
    Before { until: usize },
    /// Each sweep, by the base metric, is followed by a correction.
    Correcting(Correcting),
    /// Sweeps alone by the base metric to the end, as corrections do not help or the engine has no room for the
    /// levels.
    Without { since: usize },
}

impl<'a> Corrections<'a> {
    /// Makes the state at the start of a run.
    pub(crate) fn new(problem: &'a Problem, plan: &'a Plan) -> Self {
        Self {
            problem,
            plan,
            stage: Stage::Before { until: 1 },
            attempts: 0,
            taken: 0,
            alternated: 0,
            settled: false,
            slope: None,
            sharpness: *exponents(plan).start(),
            lowered: Vec::new(),
            accelerated: false,
            anew: false,
            has_levels: false,
            built: 0,
            fitted: 0,
            estimates: [f64::INFINITY; ESTIMATES],
            left_out: None,
            was_reopened: false,
            was_left_out: false,
        }
    }

    /// Lists all distinct steps that a run can take.
    pub(crate) fn steps(plan: &Plan) -> Vec<Step> {
        let base = plan.scheme.base();
        let by_base = [1.0, OMEGA_BEFORE, OMEGA_BETWEEN, base.properties().omega];
        let by_base = by_base.map(|omega| (base, omega));
        let others = plan.scheme.metrics().iter().filter(|&&metric| metric != base);
        let others = others.map(|&metric| (metric, OMEGA_ALTERNATING));
        let reopening = reopening_sweep(plan);
        let kinds: Vec<_> = by_base.into_iter().chain(others).chain(reopening).collect();
        let of_exponent = |sharpness| {
            let step = move |&(metric, omega)| plan.step_with(metric, omega, sharpness);
            kinds.iter().map(step)
        };
        exponents(plan).flat_map(of_exponent).collect()
    }

    /// Does up to `sweeps` further sweeps, or fewer if the run ends. Those that [reopen](reopening) triangles are not counted.
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
                Stage::Correcting(state) => self.sweep_and_correct(engine, history, state).await?,
                Stage::Without { .. } => self.sweep_without(engine).await?,
            };
            let before = self.sharpness;
            self.record(objectives, history);
            self.reopen(engine, history, self.sharpness > before).await?;
            if std::mem::take(&mut self.anew) {
                engine.forget();
            }
        }
        Ok(())
    }

    /// Returns the number of sweeps in which the metrics of the scheme took turns, once these are over.
    pub(crate) fn alternated(&self) -> Option<u32> {
        (self.attempts > 0).then_some(self.alternated)
    }

    /// Returns the number of corrections taken so far.
    pub(crate) fn taken(&self) -> u32 {
        self.taken
    }

    /// Returns the error if the run has no corrections, as the engine has no room for the levels.
    pub(crate) fn left_out(&self) -> Option<&GpuError> {
        self.left_out.as_ref()
    }

    /// Whether the run has no corrections, as the engine has no room for the levels.
    pub(crate) fn is_left_out(&self) -> bool {
        self.was_left_out || self.left_out.is_some()
    }

    fn metric(&self) -> Metric {
        self.plan.scheme.base()
    }

    /// Returns a step of the base metric, with the present exponent.
    fn step(&self, omega: f64) -> Step {
        self.plan.step_with(self.metric(), omega, self.sharpness)
    }

    /// Returns the metrics of sweeps alone, in turn. They alternate until corrections have begun once.
    fn turns(&self) -> &[Metric] {
        let metrics = self.plan.scheme.metrics();
        if self.attempts == 0 { metrics } else { &metrics[..1] }
    }

    /// Returns the step of a sweep alone, after `done` of them.
    fn step_before(&self, done: usize) -> Step {
        let turns = self.turns();
        let omega = match done {
            0 => 1.0,
            _ if self.attempts == 0 && self.plan.scheme.alternates() => OMEGA_ALTERNATING,
            _ => OMEGA_BEFORE,
        };
        self.plan.step_with(turns[done % turns.len()], omega, self.sharpness)
    }

    /// Begins a stage of corrections after `done` evaluations, with this length. What came before says nothing about it.
    fn begin_correcting(&mut self, done: usize, length: f64) {
        // EDGE's p-norm is always much stiffer across its kinks than along them, which the levels do not know.
        (self.slope, self.accelerated) = (None, !self.metric().is_smooth());
        self.anew = self.accelerated;
        self.estimates = [f64::INFINITY; ESTIMATES];
        self.lowered.clear();
        self.stage = Stage::Correcting(Correcting { since: done, length, proposed: 0, refused: 0 });
    }

    /// Does one sweep before corrections. Decides whether they begin with the next.
    async fn sweep_before(
        &mut self,
        engine: &mut impl Engine,
        history: &History,
        until: usize,
    ) -> Result<Objectives, GpuError> {
        let done = history.f().len();
        engine.sweep(&self.step_before(done - 1)).await?;
        let objectives = engine.objectives().await?;
        // If metrics alternate, compares with the last sweep by the same metric.
        let period = self.turns().len();
        let last = self.excess(history, done.saturating_sub(period));
        let f = objectives.of(self.metric()).unwrap_or(f64::NAN);
        let share = match self.attempts {
            0 if done > MANY_SWEEPS * period => MANY_SWEEPS_PAY,
            _ => SWEEPS_PAY,
        };
        let pays = 1.0 - (1.0 - share).powi(period as i32);
        let gain = last - (f - self.metric().ideal_squared());
        // Equal where f has its ideal value.
        if done >= until.max(period) && gain <= pays * last {
            if self.attempts == 0 {
                self.alternated = done as u32;
            }
            self.attempts += 1;
            self.begin_correcting(done, 1.0);
            self.lowered.extend(self.metric().is_smooth().then_some(f));
        }
        Ok(objectives)
    }

    /// Does one sweep after corrections have ended.
    async fn sweep_without(&self, engine: &mut impl Engine) -> Result<Objectives, GpuError> {
        let own = self.metric().properties().omega;
        engine.sweep(&self.step(own)).await?;
        engine.objectives().await
    }

    /// Does one sweep and then a correction, if one lowers the objective.
    async fn sweep_and_correct(
        &mut self,
        engine: &mut impl Engine,
        history: &History,
        state: Correcting,
    ) -> Result<Objectives, GpuError> {
        let Correcting { since, length: last_length, proposed, refused } = state;
        let done = history.f().len();
        let change = self.change_of_levels(history, done - 1, proposed);
        if let Some(change) = change
            && !self.change_levels(engine, change, done - 1).await?
        {
            self.stage = Stage::Without { since: done };
            return self.sweep_without(engine).await;
        }
        let (short, least_first) = match self.metric().is_smooth() {
            true => (SHORT, LEAST_FIRST),
            false => (SHORT_FOR_EDGE, LEAST_FIRST_FOR_EDGE),
        };
        let mut length = Search::first_length(last_length, least_first);
        let step = self.step(OMEGA_BETWEEN);
        let mut proposal = engine.propose(&step, length, self.accelerated).await?;
        // Levels by which a correction of all vertices leads uphill are no longer of the present stiffness.
        let misleads = proposal.slope > 0.0 && !self.metric().is_smooth();
        let proposed = if misleads { self.drop_levels(engine) } else { proposed + 1 };
        if proposal.slope < 0.0 && proposal.there.is_none() && step.shape_guard.is_finite() {
            proposal = engine.leave_out(length, !self.accelerated).await?;
        }
        let Proposal { here, slope, there } = proposal;
        // The slope is the squared norm of the gradient, weighted by the levels: about twice what is left to gain in
        // smooth modes. The other modes are left to sweeps, each of which removes most of them.
        let ideal = self.metric().ideal_squared();
        let scale = (here + ideal).max(LEAST_SCALE);
        let swept = self.lowered.last().map_or(f64::INFINITY, |f| f - ideal - here);
        self.settled = slope.abs() <= NOISE * scale
            && swept <= (SWEPT * self.plan.stop.tolerance).max(NOISE) * scale;
        let mut search = Search::new(here, slope);
        if slope < 0.0 && !self.settled {
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
                (there, length, if length < short { refused + 1 } else { 0 })
            }
            None => (here, last_length, refused + 1),
        };
        // The secant pairs may be the reason why a direction fails, so they are dropped.
        let slow = self.slope.is_some_and(|before| slope < ACCELERATED_FROM * before);
        self.accelerated = (self.accelerated || slow) && refused == 0;
        self.slope = Some(slope);
        self.stage = match refused {
            // With the last exponent, what is left is near the errors of single precision.
            MOST_REFUSED if self.attempts == ATTEMPTS || self.has_grown() => {
                Stage::Without { since: done }
            }
            MOST_REFUSED => Stage::Before { until: done + SWEEPS_BETWEEN },
            _ => Stage::Correcting(Correcting { since, length, proposed, refused }),
        };
        self.lowered.push(ideal + excess);
        // If f may rise, the engine stores the best state when it evaluates the objectives.
        if self.plan.track_all || !self.plan.is_monotone() {
            return engine.objectives().await;
        }
        let mut objectives = Objectives::untracked();
        objectives.set(self.metric(), ideal + excess);
        Ok(objectives)
    }

    /// Returns the excess of the base objective over its ideal value, at an index of the history.
    fn excess(&self, history: &History, evaluation: usize) -> f64 {
        history.f()[evaluation] - self.metric().ideal_squared()
    }

    /// Records objectives and applies the stop rule to the present stage.
    fn record(&mut self, objectives: Objectives, history: &mut History) {
        history.add(objectives);
        // The decay is extrapolated from the present stage only, and from the last exponent only. With corrections a
        // window of one sweep is enough, as they leave no slow modes.
        let (of_stage, window) = match self.stage {
            Stage::Before { .. } => (history.f(), NO_ESTIMATE),
            // A refused correction gains little, however much is left to gain.
            Stage::Correcting(Correcting { refused: 1.., .. }) => (&self.lowered[..], NO_ESTIMATE),
            Stage::Correcting(_) => (&self.lowered[..], 1),
            Stage::Without { since } => {
                (&history.f()[since..], StopRule::window(&self.metric().into()) as usize)
            }
        };
        let window = if self.is_sharpest() { window } else { NO_ESTIMATE };
        // Corrections may lower another objective than f, but the goal and the number of sweeps refer to f.
        let rule = history.rule();
        let of_f = StopRule { tolerance: 0.0, ..rule }.judge(history.f(), 0, NO_ESTIMATE);
        let target = rule.target.map(|_| f64::NEG_INFINITY);
        let tolerance = self.tolerance_of_norm(rule.tolerance);
        let rule = StopRule { target, tolerance, max_sweeps: u32::MAX };
        let mut remaining = rule.remaining(of_stage, window);
        let mut judged = window;
        if self.accelerated {
            self.estimates.rotate_left(1);
            self.estimates[ESTIMATES - 1] = remaining.map_or(f64::INFINITY, |left| CAUTION * left);
            let asked = match self.metric().is_smooth() {
                _ if decays_steadily(of_stage) => 1,
                true => ESTIMATES,
                false => ESTIMATES_FOR_EDGE,
            };
            let most = self.estimates.iter().rev().take(asked).copied().fold(0.0, f64::max);
            remaining = Some(most).filter(|most| most.is_finite());
            judged = if most <= rule.tolerance { window } else { NO_ESTIMATE };
        }
        let mut of_decay = rule.judge(of_stage, least(of_stage), judged);
        if self.settled && self.is_sharpest() {
            remaining = Some(NOISE);
            of_decay = of_decay.or(match (rule.target, rule.tolerance > 0.0) {
                (Some(_), _) => Some(Stop::Stalled),
                (None, true) => Some(Stop::Converged),
                (None, false) => None,
            });
        }
        // f cannot fall below its ideal value, so no estimate is needed where it is nearly there.
        let f = history.last();
        let above_ideal = (f - self.metric().ideal_squared()) / f.max(LEAST_SCALE);
        let asked = history.rule().tolerance;
        let bound = Some(above_ideal.max(NOISE))
            .filter(|&most| asked > 0.0 && most <= asked && f.is_finite());
        of_decay = of_decay.or(bound.filter(|_| target.is_none()).map(|_| Stop::Converged));
        let remaining = remaining.map(|left| left + self.above());
        let remaining = remaining.into_iter().chain(bound).reduce(f64::min);
        let stop = match of_f {
            Some(Stop::Reached) => of_f,
            _ => of_decay.or(of_f),
        };
        if stop.is_none() && !self.is_sharpest() && self.gains_little(history) {
            self.raise_exponent(history.f().len() - 1);
        }
        history.end(stop, remaining);
    }
}

/// Returns the index of the least value, the first if there are several.
fn least(values: &[f64]) -> usize {
    let indices = 0..values.len();
    indices.min_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap_or(0)
}

/// Whether the last two gains of f were each less than [`STEADY`] times the one before.
fn decays_steadily(f: &[f64]) -> bool {
    let [.., a, b, c, d] = f else { return false };
    let gains = [a - b, b - c, c - d];
    gains.windows(2).all(|pair| pair[1] < STEADY * pair[0])
}
