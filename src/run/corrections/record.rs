//! The log of a run with corrections, and the stop rule for each stage of such a run.

use super::slow_decay::{WINDOW, remaining_over_windows};
use super::state::{Correcting, Corrections, ESTIMATES, SWEPT, Stage};
use crate::run::history::History;
use crate::run::objectives::Objectives;
use crate::run::stop::{JITTER, MIN_SCALE, NOISE, Stop, StopRule};

/// Window longer than any history, which turns off the tests of the stop rule that depend on the decay.
const NO_ESTIMATE: usize = 1 << 30;

/// Number of successive estimates that end a run by EDGE if all are below the tolerance. Fewer than [`ESTIMATES`]
/// suffice, as the estimates are of a p-norm near f.
const ESTIMATES_FOR_EDGE: usize = 2;
/// Ratio of two successive gains of f, below which f decays steadily and a single estimate suffices.
const STEADY: f64 = 0.3;
/// Factor on the estimates. In some runs, each correction gained half as much as the previous one, and modes remained
/// that the last corrections had not touched. With three estimates and without the factor, 5 of 21 runs from hard
/// starts estimated too little, by up to a third.
const CAUTION: f64 = 1.5;

impl Corrections {
    /// Records the objectives of a sweep, applies the stop rule to the present stage, and doubles EDGE's exponent if
    /// due. `noise` is the relative error of f on the engine.
    pub(super) fn record(&mut self, objectives: Objectives, history: &mut History, noise: f64) {
        history.add(objectives);
        // The decay is extrapolated only from the present stage, and only with the last exponent. With corrections, a
        // window of one sweep is enough, as corrections leave no slow modes.
        let (of_stage, window) = match self.stage {
            Stage::Before { .. } => (history.f(), NO_ESTIMATE),
            // A refused correction gains little, even if much is left to gain.
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
                // New levels on a strongly stretched mesh gain much at first, and slow modes remain.
                _ if decays_steadily(of_stage) && !self.has_local_maps() => 1,
                true => ESTIMATES,
                false => ESTIMATES_FOR_EDGE,
            };
            let most = self.estimates.iter().rev().take(asked).copied().fold(0.0, f64::max);
            remaining = Some(most).filter(|most| most.is_finite());
            judged = if most <= rule.tolerance { window } else { NO_ESTIMATE };
        }
        let is_decay = self.metric().is_smooth() && !self.is_staged;
        let mut is_slow = false;
        if is_decay && self.taken as usize > 2 * WINDOW {
            // Without a tolerance, only the end of a run toward a goal depends on the windows.
            let noise = if rule.tolerance > 0.0 { noise } else { JITTER };
            if let Some(left) = remaining_over_windows(&rule, history.f(), noise) {
                remaining = remaining.map(|least| least.max(left)).filter(|left| left.is_finite());
                is_slow = left > rule.tolerance;
                judged = if is_slow { NO_ESTIMATE } else { judged };
            }
        }
        let mut of_decay = rule.judge(of_stage, least(of_stage), judged);
        if of_decay == Some(Stop::Converged) && remaining.is_none() {
            remaining = Some(rule.level(of_stage, judged));
        }
        let is_settled = self.settled && self.is_sharpest() && !is_slow;
        if is_settled {
            // Another sweep may gain as much as the last.
            remaining = Some((SWEPT * rule.tolerance).max(NOISE));
            of_decay = of_decay.or(match (rule.target, rule.tolerance > 0.0) {
                (Some(_), _) => Some(Stop::Stalled),
                (None, true) => Some(Stop::Converged),
                (None, false) => None,
            });
        }
        // f cannot fall below its lower limit, so near the limit the distance is known without an estimate.
        let f = history.last();
        let above_least = (f - self.least_objective()) / f.max(MIN_SCALE);
        let asked = history.rule().tolerance;
        let bound = Some(above_least.max(NOISE))
            .filter(|&most| asked > 0.0 && most <= asked && f.is_finite());
        of_decay = of_decay.or(bound.filter(|_| target.is_none()).map(|_| Stop::Converged));
        // An extrapolation cannot show less than the tolerance: modes that fewer sweeps have not touched may remain.
        let is_extrapolated = of_decay == Some(Stop::Converged) && !is_settled;
        let least_left = if is_extrapolated { history.rule().tolerance } else { 0.0 };
        let remaining = remaining.map(|left| (left + self.above()).max(least_left));
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

/// Returns the index of the smallest value, the first of several equal ones. 0 if there are no values.
fn least(values: &[f64]) -> usize {
    let indices = 0..values.len();
    indices.min_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap_or(0)
}

/// Returns whether each of the last two gains of f was less than [`STEADY`] times the gain before.
fn decays_steadily(f: &[f64]) -> bool {
    let [.., a, b, c, d] = f else { return false };
    let gains = [a - b, b - c, c - d];
    gains.windows(2).all(|pair| pair[1] < STEADY * pair[0])
}
