//! The log of a run with corrections, and the stop rule for each stage of such a run.

use super::state::{Correcting, Corrections, ESTIMATES, SWEEPS_BETWEEN, SWEPT, Stage};
use crate::error::GpuError;
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::objectives::Objectives;
use crate::run::progress::GoesOn;
use crate::run::stop::{MIN_SCALE, NOISE, Stop, StopRule};
use crate::run::truncated::Tail;

/// Window longer than any history, which turns off the tests of the stop rule that depend on the decay.
const NO_ESTIMATE: usize = 1 << 30;

/// Smallest remaining gain that a run reports because a correction and a sweep gained next to nothing. Gains below
/// [`NOISE`] are not seen, and slow modes hold many such gains: up to 1.9e-8 was found to remain.
const LEAST_SETTLED: f64 = 10.0 * NOISE;
/// Ratio of two successive gains of f, below which f decays steadily and a single estimate suffices.
const STEADY: f64 = 0.3;
/// Factor on the estimates by EDGE. In some runs, each correction gained half as much as the previous one, and modes remained
/// that the last corrections had not touched. With three estimates and without the factor, 5 of 21 runs from hard
/// starts estimated too little, by up to a third.
const CAUTION: f64 = 1.5;
/// Multiple of the tolerance from which a measured gain may be one that a bound or a guard forbids. Around a vertex of 50, a run by
/// `rms`, whose guard held no vertex, left 2.7 times the tolerance.
const FORBIDDEN: f64 = 10.0;
/// Smallest remaining gain that a run reports by an extrapolation if bounds or a guard may hold vertices, as a multiple of the
/// tolerance. Of 230 runs on random meshes, 2.2 to 3.9 times the tolerance was found to remain after four.
const LEAST_IF_HELD: f64 = 2.0;
/// Number of ends that a measurement may refuse. With bounds or a guard, a measurement refuses one end at most.
const MOST_REFUSED_ENDS: u32 = 8;

/// Decrease of the objective by a sweep, as a share of the objective, above which gains do not predict the remaining
/// gain. The first correction of a stage may lower f to a third and the second by a tenth of that, with f a thousand
/// times the limit. No run with a tolerance of 0.01 was found to depend on this bound.
const STEEP: f64 = 0.03;

impl Corrections {
    /// Records the objectives of a sweep, applies the stop rule to the present stage, and doubles EDGE's exponent if
    /// due.
    pub(super) async fn record(
        &mut self,
        engine: &mut impl Engine,
        objectives: Objectives,
        history: &mut History,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<(), GpuError> {
        history.add(objectives);
        let whole = history.rule();
        // Corrections may lower another objective than f, but the goal and the number of sweeps refer to f.
        let of_f = StopRule { tolerance: 0.0, ..whole }.judge(history.f(), 0, NO_ESTIMATE);
        if let Stage::Stepping { left } = self.stage {
            self.judge_step(left, of_f, history);
            return Ok(());
        }
        let rule = StopRule {
            goal: whole.goal.map(|_| f64::NEG_INFINITY),
            tolerance: self.tolerance_of_norm(whole.tolerance),
            max_sweeps: u32::MAX,
        };
        let (mut remaining, mut end) = self.judged_by_decay(&rule, history);
        let is_settled = self.settled && self.is_sharpest();
        if is_settled {
            // Another sweep may gain as much as the last.
            remaining = Some((SWEPT * rule.tolerance).max(LEAST_SETTLED));
            end = end.or(match (rule.goal, rule.tolerance > 0.0) {
                (Some(_), _) => Some(Stop::Stalled),
                (None, true) => Some(Stop::Converged),
                (None, false) => None,
            });
        }
        let bound = self.bound(history);
        let is_at_bound = bound.is_some() && rule.goal.is_none();
        let mut end = end.or(is_at_bound.then_some(Stop::Converged));
        // An extrapolation cannot show less than the tolerance: modes that fewer sweeps have not touched may remain.
        let is_extrapolated = end == Some(Stop::Converged) && !is_settled;
        let least = if self.is_held { LEAST_IF_HELD * whole.tolerance } else { whole.tolerance };
        let least_left = if is_extrapolated { least } else { 0.0 };
        let remaining = remaining.map(|left| (left + self.above()).max(least_left));
        let mut remaining = remaining.into_iter().chain(bound).reduce(f64::min);
        if end.is_some() && of_f != Some(Stop::Reached) && bound.is_none() {
            (remaining, end) = self.measured(engine, history, remaining, end, goes_on).await?;
        }
        let stop = if of_f == Some(Stop::Reached) { of_f } else { end.or(of_f) };
        if stop.is_none() && self.tries_again(history) {
            self.correct_again(history);
        }
        if stop.is_none() && !self.is_sharpest() && self.gains_little(history) {
            self.raise_exponent(history.f().len() - 1);
        }
        history.end(stop, remaining);
        Ok(())
    }

    /// Applies the stop rule to the decay of the objective in the present stage. Returns the estimated remaining gain as a
    /// share of f, and the reason for which the objective ends the run. Both are `None` if they are missing.
    fn judged_by_decay(
        &mut self,
        rule: &StopRule,
        history: &History,
    ) -> (Option<f64>, Option<Stop>) {
        let (of_stage, mut window) = self.values_of_stage(history);
        let mut remaining = rule.remaining(&of_stage, window);
        if !self.metric().is_smooth() {
            (remaining, window) = self.confirmed(remaining, window, &of_stage, rule);
        }
        if is_steep(&of_stage) {
            window = NO_ESTIMATE;
        }
        let end = rule.judge(&of_stage, least(&of_stage), window);
        let is_level = end == Some(Stop::Converged) && remaining.is_none();
        let level = is_level.then(|| rule.level(&of_stage, window));
        (remaining.or(level), end)
    }

    /// Measures the end of a run by a smooth metric: the remaining gain is that of a further Newton step of all vertices, by its
    /// quadratic model. If more is left than the tolerance, or if the model of f curves down, corrections begin again with new levels. A
    /// bound or a guard may forbid a large gain, which then refuses no end. Returns the remaining gain and the end.
    async fn measured(
        &mut self,
        engine: &mut impl Engine,
        history: &History,
        estimate: Option<f64>,
        end: Option<Stop>,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<(Option<f64>, Option<Stop>), GpuError> {
        if !self.is_measured() {
            return Ok((estimate, end));
        }
        let last = history.f().len() - 1;
        if last < self.unmeasured_until {
            return Ok((estimate, None));
        }
        let step = self.step(1.0);
        let rule = history.rule();
        let f = history.last().max(MIN_SCALE);
        let tolerance = rule.tolerance.max(LEAST_SETTLED);
        let left = engine.remaining(&step, &Tail::measuring(f, tolerance), goes_on).await?;
        let left = left.map(|left| (left / f).max(NOISE));
        if left.is_some_and(|left| left <= tolerance) {
            let has_tolerance = rule.goal.is_none() && rule.tolerance > 0.0;
            return Ok((left, if has_tolerance { Some(Stop::Converged) } else { end }));
        }
        if self.is_held && left.is_none_or(|left| left > FORBIDDEN * tolerance) {
            return Ok((estimate, end));
        }
        let most = if self.is_held { 1 } else { MOST_REFUSED_ENDS };
        if self.refused_ends == most || self.is_left_out() {
            return Ok((left.or(estimate), end));
        }
        self.refused_ends += 1;
        self.unmeasured_until = last + (last / 4).max(SWEEPS_BETWEEN);
        self.drop_levels(engine);
        self.correct_again(history);
        (self.accelerated, self.anew) = (true, true);
        Ok((left.or(estimate), None))
    }

    /// Returns the values of the objective in the present stage, and the window in sweeps over which the stop rule
    /// extrapolates their decay. With corrections, a window of one sweep is enough, as corrections leave no slow modes.
    fn values_of_stage(&self, history: &History) -> (Vec<f64>, usize) {
        let (values, window) = match self.stage {
            Stage::Before { .. } | Stage::Stepping { .. } => (history.f(), NO_ESTIMATE),
            // A refused correction gains little, even if much is left to gain.
            Stage::Correcting(Correcting { refused: 1.., .. }) => (&self.lowered[..], NO_ESTIMATE),
            Stage::Correcting(_) => (&self.lowered[..], 1),
            Stage::Without { since } => {
                (&history.f()[since..], StopRule::window(&self.metric().into()) as usize)
            }
        };
        // Only with the last exponent is a decay of EDGE's p-norm the decay to the end of the run.
        (values.to_vec(), if self.is_sharpest() { window } else { NO_ESTIMATE })
    }

    /// Begins a stage of corrections after the latest sweep.
    fn correct_again(&mut self, history: &History) {
        self.begin_correcting(history.f().len() - 1, 1.0);
        self.lowered.push(history.last());
    }

    /// Returns whether corrections begin again because sweeps without corrections have doubled the number of sweeps. Corrections
    /// that were refused on a rough mesh may succeed on the smoothed mesh, and lower modes that sweeps alone hardly change.
    fn tries_again(&self, history: &History) -> bool {
        let Stage::Without { since } = self.stage else { return false };
        let (last, window) = (history.f().len() - 1, StopRule::window(&self.metric().into()));
        let is_due = last >= 2 * since && last - since > 2 * window as usize;
        is_due && self.metric().is_smooth() && !self.is_left_out()
    }

    /// Records an estimate of a run by EDGE, whose gains are irregular. Returns the largest of the
    /// latest estimates and the window for the stop rule, or no window if that estimate is above the tolerance.
    fn confirmed(
        &mut self,
        remaining: Option<f64>,
        window: usize,
        of_stage: &[f64],
        rule: &StopRule,
    ) -> (Option<f64>, usize) {
        self.estimates.rotate_left(1);
        self.estimates[ESTIMATES - 1] = remaining.map_or(f64::INFINITY, |left| CAUTION * left);
        let asked = if decays_steadily(of_stage) { 1 } else { ESTIMATES };
        let most = self.estimates.iter().rev().take(asked).copied().fold(0.0, f64::max);
        let window = if most <= rule.tolerance { window } else { NO_ESTIMATE };
        (Some(most).filter(|most| most.is_finite()), window)
    }

    /// Returns the distance of f from its lower limit as a share of f, if the distance is within the tolerance of the
    /// run. f cannot fall below the limit, so no estimate is needed there.
    fn bound(&self, history: &History) -> Option<f64> {
        let (f, tolerance) = (history.last(), history.rule().tolerance);
        let above_least = (f - self.least) / f.max(MIN_SCALE);
        let is_within = tolerance > 0.0 && above_least.max(NOISE) <= tolerance && f.is_finite();
        is_within.then_some(above_least.max(NOISE))
    }
}

/// Returns the index of the smallest value, the first of several equal ones. 0 if there are no values.
fn least(values: &[f64]) -> usize {
    let indices = 0..values.len();
    indices.min_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap_or(0)
}

/// Returns whether the last sweep has lowered f by more than [`STEEP`] of f.
fn is_steep(f: &[f64]) -> bool {
    let [.., before, now] = f else { return false };
    before - now > STEEP * now.max(MIN_SCALE)
}

/// Returns whether each of the last two gains of f was less than [`STEADY`] times the gain before.
fn decays_steadily(f: &[f64]) -> bool {
    let [.., a, b, c, d] = f else { return false };
    let gains = [a - b, b - c, c - d];
    gains.windows(2).all(|pair| pair[1] < STEADY * pair[0])
}
