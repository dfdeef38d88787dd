//! The log of a run with corrections, and the stop rule for each stage of such a run.

use super::slow_decay::{WINDOW, remaining_over_windows};
use super::state::{ATTEMPTS, Correcting, Corrections, ESTIMATES, SWEPT, Stage};
use crate::run::history::History;
use crate::run::objectives::Objectives;
use crate::run::stop::{JITTER, MIN_SCALE, NOISE, Stop, StopRule};

/// Window longer than any history, which turns off the tests of the stop rule that depend on the decay.
const NO_ESTIMATE: usize = 1 << 30;

/// Number of successive estimates that end a run by EDGE if all are below the tolerance. Fewer than [`ESTIMATES`]
/// suffice, as the estimates are of a p-norm near f.
const ESTIMATES_FOR_EDGE: usize = 2;
/// Number of times that corrections begin, after which a refused correction no longer prevents the end of a run. Near
/// vertices that a guard holds back, every correction may be refused.
const MOST_ATTEMPTS: u32 = ATTEMPTS + 2;
/// Multiple of the tolerance that a refused correction must promise to prevent the end of a run.
const DOUBT: f64 = 5.0;
/// Smallest remaining gain that a run reports because a correction and a sweep gained next to nothing. Gains below
/// [`NOISE`] are not seen, and slow modes hold many such gains: up to 1.9e-8 was found to remain.
const LEAST_SETTLED: f64 = 10.0 * NOISE;
/// Ratio of two successive gains of f, below which f decays steadily and a single estimate suffices.
const STEADY: f64 = 0.3;
/// Factor on the estimates. In some runs, each correction gained half as much as the previous one, and modes remained
/// that the last corrections had not touched. With three estimates and without the factor, 5 of 21 runs from hard
/// starts estimated too little, by up to a third.
const CAUTION: f64 = 1.5;

/// Smallest remaining gain that a run reports after many corrections or around a hub, as a multiple of the tolerance. The
/// square applies after many corrections around a hub. Levels that take more than 16 corrections leave modes that decay by
/// a hundredth per correction once the other modes are gone. 2.6 times the tolerance was found to remain around a vertex
/// of 50 after 44 corrections, 2.7 times the tolerance around a vertex of 100 after six, and up to 5.4 times the
/// tolerance around vertices of 200 after 120 to 180.
const SLOW_MODES: f64 = 2.0;

/// Decrease of the objective by a sweep, as a share of the objective, above which gains do not predict the remaining
/// gain. The first correction of a stage may lower f to a third and the second by a tenth of that, with f a thousand
/// times the limit. No run with a tolerance of 0.01 was found to depend on this bound.
const STEEP: f64 = 0.03;

/// The judgment of the stop rule after a sweep.
struct Judged {
    /// Estimate of the remaining gain as a share of f. `None` without an estimate.
    remaining: Option<f64>,
    /// Reason for which the objective of the stage ends the run. `None` if the run continues.
    end: Option<Stop>,
    /// Whether f decays so slowly that more than the tolerance remains.
    is_slow: bool,
}

impl Corrections {
    /// Records the objectives of a sweep, applies the stop rule to the present stage, and doubles EDGE's exponent if
    /// due. `noise` is the relative error of f on the engine.
    pub(super) fn record(&mut self, objectives: Objectives, history: &mut History, noise: f64) {
        history.add(objectives);
        let whole = history.rule();
        // Corrections may lower another objective than f, but the goal and the number of sweeps refer to f.
        let of_f = StopRule { tolerance: 0.0, ..whole }.judge(history.f(), 0, NO_ESTIMATE);
        if let Stage::Stepping { left } = self.stage {
            return self.judge_step(left, of_f, history);
        }
        let rule = StopRule {
            target: whole.target.map(|_| f64::NEG_INFINITY),
            tolerance: self.tolerance_of_norm(whole.tolerance),
            max_sweeps: u32::MAX,
        };
        let mut judged = self.judged_by_decay(&rule, history, noise);
        self.doubt(&mut judged, &rule, history, noise);
        let is_settled = self.settled && self.is_sharpest() && !judged.is_slow;
        if is_settled {
            // Another sweep may gain as much as the last.
            judged.remaining = Some((SWEPT * rule.tolerance).max(LEAST_SETTLED));
            judged.end = judged.end.or(match (rule.target, rule.tolerance > 0.0) {
                (Some(_), _) => Some(Stop::Stalled),
                (None, true) => Some(Stop::Converged),
                (None, false) => None,
            });
        }
        let bound = self.bound(history);
        let is_at_bound = bound.is_some() && rule.target.is_none();
        let end = judged.end.or(is_at_bound.then_some(Stop::Converged));
        let (is_long, has_hub) =
            (self.has_corrected_long(), self.has_hub && self.metric().is_smooth());
        let slow_modes = SLOW_MODES.powi(i32::from(is_long) + i32::from(has_hub));
        let least_left = match end {
            // An extrapolation cannot show less than the tolerance: modes that fewer sweeps have not touched may remain.
            Some(Stop::Converged) if !is_settled => slow_modes * whole.tolerance,
            Some(Stop::Converged) if slow_modes > 1.0 => whole.tolerance,
            _ => 0.0,
        };
        let remaining = judged.remaining.map(|left| (left + self.above()).max(least_left));
        let remaining = remaining.into_iter().chain(bound).reduce(f64::min);
        // Around a hub, rounding hides slow modes: up to 4e-5 of f was found to remain after long runs on a device.
        let hides_slow_modes = noise > NOISE && is_long && has_hub && bound.is_none();
        let stop = match (of_f, end) {
            (Some(Stop::Reached), _) => of_f,
            (_, Some(Stop::Converged)) if hides_slow_modes => {
                self.needs_double = true;
                self.correct_again(history);
                of_f
            }
            _ => end.or(of_f),
        };
        if stop.is_none() && !self.is_sharpest() && self.gains_little(history) {
            self.raise_exponent(history.f().len() - 1);
        }
        history.end(stop, remaining);
    }

    /// Applies the stop rule to the decay of the objective in the present stage, and to the slow decay of f.
    fn judged_by_decay(&mut self, rule: &StopRule, history: &History, noise: f64) -> Judged {
        let (of_stage, mut window) = self.values_of_stage(history);
        let mut remaining = rule.remaining(&of_stage, window);
        let is_correcting = matches!(self.stage, Stage::Correcting(_));
        if self.accelerated || is_correcting && self.has_hub {
            // A single sweep that gains more than the previous one is no evidence against a decay.
            let over_window = || rule.remaining(history.f(), WINDOW).filter(|_| self.decays_long());
            remaining = remaining.or_else(over_window);
            (remaining, window) = self.confirmed(remaining, window, &of_stage, rule);
        }
        let slow = self.slow_decay(rule, history, noise);
        let is_slow = slow.is_some_and(|left| left > rule.tolerance);
        if let Some(left) = slow {
            remaining = remaining.map(|least| least.max(left)).filter(|left| left.is_finite());
        }
        if is_slow || is_steep(&of_stage) {
            window = NO_ESTIMATE;
        }
        let end = rule.judge(&of_stage, least(&of_stage), window);
        let is_level = end == Some(Stop::Converged) && remaining.is_none();
        let level = is_level.then(|| rule.level(&of_stage, window));
        Judged { remaining: remaining.or(level), end, is_slow }
    }

    /// Prevents the end of a stage of sweeps alone if corrections have not had a fair trial: corrections begin again if
    /// they are due, and a refused correction that promises a large gain prevents the end. If the stage would end a run in
    /// single precision, corrections begin again in double precision, because rounding refuses small corrections. Ends the
    /// run if corrections that began again at its end gained little and promise little.
    fn doubt(&mut self, judged: &mut Judged, rule: &StopRule, history: &History, noise: f64) {
        let is_single = noise > NOISE;
        let promised = self.promised(history);
        let much = promised.filter(|left| *left > DOUBT * rule.tolerance);
        let may_be_early = much.is_some() || !is_single;
        if self.tries_again(history, judged.end, may_be_early) {
            // Only tries at the end count: a stage that has doubled the number of sweeps may be far from the end.
            let end = judged.end.take();
            self.attempts += u32::from(end.is_some());
            self.needs_double = end.is_some() && is_single;
            self.correct_again(history);
            self.from_end = end == Some(Stop::Converged);
        } else if let (Some(Stop::Converged), Some(promised)) = (judged.end, much) {
            // The decay of f in sweeps alone is then no evidence for convergence.
            judged.remaining = judged.remaining.map(|left| left.max(promised));
            judged.end = judged.end.filter(|_| self.attempts >= MOST_ATTEMPTS);
        } else if self.gained_little_from_end(history, rule.tolerance)
            && let (Some(promised), None) = (promised, much)
        {
            judged.remaining = Some(promised.max(rule.tolerance));
            judged.end = judged.end.or(Some(Stop::Converged));
        }
    }

    /// Begins a stage of corrections after the latest sweep.
    fn correct_again(&mut self, history: &History) {
        self.begin_correcting(history.f().len() - 1, 1.0);
        self.lowered.push(history.last());
    }

    /// Returns whether corrections that began when sweeps alone would have ended the run have just been refused, and have
    /// gained less than the tolerance, as a share of f.
    fn gained_little_from_end(&self, history: &History, tolerance: f64) -> bool {
        let last = history.f().len() - 1;
        let was_refused = matches!(self.stage, Stage::Without { since } if since == last);
        let gained = self.lowered.first().map_or(f64::INFINITY, |f| f - history.last());
        was_refused && self.from_end && gained <= tolerance * history.last().max(MIN_SCALE)
    }

    /// Returns whether corrections begin again after a stage of sweeps alone, because the stage would end the run for
    /// `end`, or, if `may_be_early`, because the stage has doubled the number of sweeps. Corrections that were refused on
    /// a rough mesh may succeed on the smoothed mesh, and lower modes that sweeps alone hardly change. A stage that ends
    /// as early as the stop rule permits follows a refused correction, and may end the run.
    fn tries_again(&self, history: &History, end: Option<Stop>, may_be_early: bool) -> bool {
        let Stage::Without { since } = self.stage else { return false };
        let (last, window) = (history.f().len() - 1, StopRule::window(&self.metric().into()));
        let is_due = end.is_some() || may_be_early && last >= 2 * since;
        let is_long = last - since > 2 * window as usize;
        is_due && is_long && self.metric().is_smooth() && !self.is_left_out()
    }

    /// Returns the gain in smooth modes that the last correction, which was refused, promised as a share of f: half of its
    /// slope. `None` except in a stage of sweeps alone.
    fn promised(&self, history: &History) -> Option<f64> {
        let is_without = matches!(self.stage, Stage::Without { .. }) && !self.is_left_out();
        let slope = self.slope.filter(|_| is_without && self.metric().is_smooth())?;
        Some(0.5 * slope.abs() / history.last().max(MIN_SCALE))
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

    /// Records an estimate of a run with accelerated corrections or around a hub, whose gains are irregular. Returns the largest of the
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
        let asked = match self.metric().is_smooth() {
            // New levels on a strongly stretched mesh gain much at first, and slow modes remain.
            _ if decays_steadily(of_stage) && !self.has_local_maps() && !self.has_hub => 1,
            true => ESTIMATES,
            false => ESTIMATES_FOR_EDGE,
        };
        let most = self.estimates.iter().rev().take(asked).copied().fold(0.0, f64::max);
        let window = if most <= rule.tolerance { window } else { NO_ESTIMATE };
        (Some(most).filter(|most| most.is_finite()), window)
    }

    /// Returns whether a run by a smooth metric has taken so many corrections that slow modes may remain.
    fn has_corrected_long(&self) -> bool {
        self.metric().is_smooth() && self.taken as usize > 2 * WINDOW
    }

    /// Returns whether f has decayed over many corrections, so that its gains over windows of several sweeps predict the
    /// remaining gain. False by EDGE, and with stages between sweeps.
    fn decays_long(&self) -> bool {
        self.has_corrected_long() && !self.is_staged
    }

    /// Returns the remaining gain by the windows of a slow decay. `None` unless f decays long.
    fn slow_decay(&self, rule: &StopRule, history: &History, noise: f64) -> Option<f64> {
        if !self.decays_long() {
            return None;
        }
        // Without a tolerance, only the end of a run toward a goal depends on the windows.
        let noise = if rule.tolerance > 0.0 { noise } else { JITTER };
        remaining_over_windows(rule, history.f(), noise)
    }

    /// Returns the distance of f from its lower limit as a share of f, if the distance is within the tolerance of the
    /// run. f cannot fall below the limit, so no estimate is needed there.
    fn bound(&self, history: &History) -> Option<f64> {
        let (f, tolerance) = (history.last(), history.rule().tolerance);
        let above_least = (f - self.least_objective()) / f.max(MIN_SCALE);
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
