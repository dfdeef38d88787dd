//! The sweeps and corrections of a run, and the conditions under which corrections begin, pause and end.

use super::plan_steps::{
    OMEGA_ALTERNATING, OMEGA_BEFORE, OMEGA_BETWEEN, exponents, reopening_sweep,
};
use super::state::{ATTEMPTS, Correcting, Corrections, SWEEPS_BETWEEN, SWEPT, Stage};
use crate::error::GpuError;
use crate::metric::Metric;
use crate::run::engine::{Engine, Proposal};
use crate::run::history::History;
use crate::run::multilevel::{MIN_FIRST_LENGTH, Search};
use crate::run::objectives::Objectives;
use crate::run::plan::Plan;
use crate::run::progress::GoesOn;
use crate::run::stop::{MIN_SCALE, NOISE};
use crate::run::sweep_params::SweepParams;

/// Relative decrease of the excess of f over its lower limit by one sweep alone, below which corrections begin.
/// Earlier, a few bad triangles would force every correction to be short.
const SWEEPS_PAY: f64 = 0.1;
/// Replaces [`SWEEPS_PAY`] after [`MANY_SWEEPS`] sweeps alone. On a mesh whose ideal can be reached, each sweep may
/// lower the excess by 15 %, for hundreds of sweeps.
const MANY_SWEEPS_PAY: f64 = 0.2;
const MANY_SWEEPS: usize = 12;
/// Length below which a correction counts as refused although it is applied, as it helps little. For EDGE, lengths are
/// a tenth of the usual ones: its p-norm is stiffer across its kinks than the levels assume.
const SHORT: f64 = 0.05;
const SHORT_FOR_EDGE: f64 = 0.005;
/// Smallest first trial of a length for EDGE; see [`MIN_FIRST_LENGTH`] for other metrics.
const MIN_FIRST_FOR_EDGE: f64 = 0.1;
/// Number of consecutive refused corrections after which the run returns to sweeps alone.
const MAX_REFUSED: u32 = 2;
/// Number of corrections in one stage after which levels leave the coordinates of target maps. Most runs end before. Two
/// meshes adapted to several shocks then take 77 and 98 sweeps instead of 269 and 442.
const MOST_IN_MAPS: u32 = 32;

/// Ratio of the slopes along two successive corrections above which corrections are accelerated. On most meshes, the
/// slope falls to a sixth or less each time, and acceleration gains nothing.
const ACCELERATED_FROM: f64 = 0.3;

impl Corrections {
    /// Returns all distinct steps that a run with corrections can take.
    pub(crate) fn steps(plan: &Plan) -> Vec<SweepParams> {
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

    /// Does up to `sweeps` further sweeps, fewer if the run ends. Sweeps that
    /// [reopen](super::reopening) triangles are not counted.
    pub(crate) async fn advance(
        &mut self,
        engine: &mut impl Engine,
        history: &mut History,
        sweeps: u32,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<(), GpuError> {
        if history.is_empty() {
            let start = engine.objectives().await?;
            self.record(engine, start, history, goes_on).await?;
        }
        for _ in 0..sweeps {
            if history.stop().is_some() || !goes_on() {
                break;
            }
            let objectives = match self.stage {
                Stage::Before { until } => self.sweep_before(engine, history, until).await?,
                Stage::Correcting(state) => self.sweep_and_correct(engine, history, state).await?,
                Stage::Stepping { .. } => {
                    match self.sweep_and_step(engine, history, goes_on).await? {
                        Some(objectives) => objectives,
                        None => self.correct_instead(engine, history).await?,
                    }
                }
                Stage::Without { .. } => self.sweep_without(engine).await?,
            };
            let before = self.sharpness;
            self.record(engine, objectives, history, goes_on).await?;
            self.reopen(engine, history, self.sharpness > before).await?;
            if std::mem::take(&mut self.anew) {
                engine.forget();
            }
        }
        Ok(())
    }

    /// Returns the metrics of sweeps alone, in turn. After corrections have begun once, only the base metric is left.
    fn turns(&self) -> &[Metric] {
        let metrics = self.plan.scheme.metrics();
        if self.attempts == 0 { metrics } else { &metrics[..1] }
    }

    /// Returns the step of a sweep alone, after `done` such sweeps.
    fn step_before(&self, done: usize) -> SweepParams {
        let turns = self.turns();
        let omega = match done {
            0 => 1.0,
            _ if self.attempts == 0 && self.plan.scheme.alternates() => OMEGA_ALTERNATING,
            _ => OMEGA_BEFORE,
        };
        self.plan.step_with(turns[done % turns.len()], omega, self.sharpness)
    }

    /// Sweeps once without a correction, and decides whether corrections begin with the next sweep.
    async fn sweep_before(
        &mut self,
        engine: &mut impl Engine,
        history: &History,
        until: usize,
    ) -> Result<Objectives, GpuError> {
        let done = history.f().len();
        let objectives = engine.sweep(&self.step_before(done - 1)).await?;
        // If metrics alternate, the comparison is with the last sweep by the same metric.
        let period = self.turns().len();
        let last = self.excess(history, done.saturating_sub(period));
        let f = objectives.of(self.metric()).unwrap_or(f64::NAN);
        let share = match self.attempts {
            0 if done > MANY_SWEEPS * period => MANY_SWEEPS_PAY,
            _ => SWEEPS_PAY,
        };
        let pays = 1.0 - (1.0 - share).powi(period as i32);
        let gain = last - (f - self.least);
        // The two sides are equal if f has its least value.
        if done >= until.max(period) && gain <= pays * last {
            if self.attempts == 0 {
                self.alternated = done as u32;
            }
            self.attempts += 1;
            if self.can_step {
                self.stage = Stage::Stepping { left: None };
                return Ok(objectives);
            }
            self.begin_correcting(done, 1.0);
            self.lowered.extend(self.metric().is_smooth().then_some(f));
        }
        Ok(objectives)
    }

    /// Begins corrections on an engine that takes no Newton steps of all vertices, with a sweep and the first correction.
    async fn correct_instead(
        &mut self,
        engine: &mut impl Engine,
        history: &History,
    ) -> Result<Objectives, GpuError> {
        self.can_step = false;
        self.begin_correcting(history.f().len() - 1, 1.0);
        self.lowered.push(history.last());
        match self.stage {
            Stage::Correcting(state) => self.sweep_and_correct(engine, history, state).await,
            _ => self.sweep_without(engine).await,
        }
    }

    /// Sweeps once in the stage after the last correction.
    async fn sweep_without(&self, engine: &mut impl Engine) -> Result<Objectives, GpuError> {
        let own = self.metric().properties().omega;
        engine.sweep(&self.step(own)).await
    }

    /// Sweeps once, then computes a correction and applies it if it lowers the objective.
    async fn sweep_and_correct(
        &mut self,
        engine: &mut impl Engine,
        history: &History,
        state: Correcting,
    ) -> Result<Objectives, GpuError> {
        let Correcting { since, length: last_length, proposed, refused } = state;
        let done = history.f().len();
        if proposed == MOST_IN_MAPS && !engine.problem().has_local_maps() {
            self.leave_maps(engine)?;
        }
        let change = self.change_of_levels(engine.problem(), history, done - 1, proposed);
        if let Some(change) = change
            && !self.change_levels(engine, change, done - 1).await?
        {
            self.stage = Stage::Without { since: done };
            return self.sweep_without(engine).await;
        }
        let is_smooth = self.metric().is_smooth();
        let least_first = if is_smooth { MIN_FIRST_LENGTH } else { MIN_FIRST_FOR_EDGE };
        let length = Search::first_length(last_length, least_first);
        let step = self.step(OMEGA_BETWEEN);
        let mut proposal = engine.sweep_and_propose(&step, length, self.accelerated).await?;
        // If the correction of all vertices leads uphill, the levels no longer fit the stiffness of the mesh.
        let misleads = proposal.slope > 0.0 && !is_smooth;
        let proposed = if misleads { self.drop_levels(engine) } else { proposed + 1 };
        let can_break = step.shape_guard.is_finite() || engine.problem().least_altitude() > 0.0;
        if proposal.slope < 0.0 && proposal.there.is_none() && can_break {
            proposal = engine.exclude_broken(length, !self.accelerated).await?;
        }
        let best = self.search_along(engine, &proposal, length).await?;
        let Proposal { here, slope, .. } = proposal;
        let (moved, excess) = best.map_or((None, here), |(by, there)| (Some(by), there));
        let evaluated = self.apply(engine, moved).await?;
        let short = if is_smooth { SHORT } else { SHORT_FOR_EDGE };
        let refused = if moved.is_some_and(|by| by >= short) { 0 } else { refused + 1 };
        let length = moved.unwrap_or(last_length);
        // Secant pairs may be the reason why a direction fails, so a refused correction drops them.
        let slow = self.slope.is_some_and(|before| slope < ACCELERATED_FROM * before);
        self.accelerated = (self.accelerated || slow) && refused == 0;
        self.slope = Some(slope);
        self.stage = match refused {
            // With the last exponent, the remaining gain is near the errors of single precision.
            MAX_REFUSED if self.attempts >= ATTEMPTS || self.has_grown() => {
                Stage::Without { since: done }
            }
            MAX_REFUSED => {
                self.leave_maps(engine)?;
                Stage::Before { until: done + SWEEPS_BETWEEN }
            }
            _ => Stage::Correcting(Correcting { since, length, proposed, refused }),
        };
        let f = self.metric().ideal_squared() + excess;
        self.lowered.push(f);
        Ok(evaluated.unwrap_or_else(|| {
            let mut objectives = Objectives::empty();
            objectives.set(self.metric(), f);
            objectives
        }))
    }

    /// Searches along a correction from its first length, and finds whether the run is settled. Returns the best length with
    /// f - ideal² there; `None` if no length lowers f.
    async fn search_along(
        &mut self,
        engine: &mut impl Engine,
        proposal: &Proposal,
        mut length: f64,
    ) -> Result<Option<(f64, f64)>, GpuError> {
        let Proposal { here, slope, there } = *proposal;
        // The slope is the squared norm of the gradient, weighted by the levels: about twice the gain left in smooth
        // modes. Sweeps remove the other modes, most of them in a single sweep.
        let ideal = self.metric().ideal_squared();
        let scale = (here + ideal).max(MIN_SCALE);
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
        Ok(search.best())
    }

    /// Moves the vertices by a length along a correction, if given. Returns the objectives if the engine evaluates them.
    async fn apply(
        &mut self,
        engine: &mut impl Engine,
        moved: Option<f64>,
    ) -> Result<Option<Objectives>, GpuError> {
        // If f may rise, the engine evaluates the objectives and stores the best state.
        let is_evaluated = self.plan.track_all || !self.plan.is_monotone();
        self.taken += u32::from(moved.is_some());
        Ok(match moved {
            Some(by) if is_evaluated => Some(engine.objectives_after_move(by).await?),
            None if is_evaluated => Some(engine.objectives().await?),
            Some(by) => {
                engine.move_along(by).await?;
                None
            }
            None => None,
        })
    }
}
