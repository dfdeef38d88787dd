//! The stop rule: whether a run ends after a sweep, judged from the history of the base objective.

use crate::metric::Scheme;

/// The reason why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Stop {
    /// The base objective has reached the value that the [`Goal`](crate::Goal) of the run asks for.
    Reached,
    /// The estimated distance to the limit is below the tolerance, or f no longer changes.
    Converged,
    /// The base objective no longer improves. A goal is out of reach, or the sweeps of an alternating scheme lead away
    /// from the optimum of the base metric.
    Stalled,
    /// f no longer changes, but only because the shape guard holds vertices back. By the metric alone, the vertices
    /// would flatten triangles further. [`Outcome::held_back`](crate::Outcome::held_back) is the number of such
    /// vertices.
    HeldBack,
    /// The run has done [`Options::max_sweeps`](crate::Options::max_sweeps) sweeps.
    MaxSweeps,
    /// The [`Observer`](crate::Observer) ended the run.
    Canceled,
    /// A sweep made f infinite or NaN, which indicates a defect. The run returned to its last saved state, and so undid
    /// later sweeps.
    NotFinite,
}

impl Stop {
    /// Returns the reason in one word, for reports.
    pub fn name(self) -> &'static str {
        match self {
            Stop::Reached => "reached",
            Stop::Converged => "converged",
            Stop::Stalled => "stalled",
            Stop::HeldBack => "held-back",
            Stop::MaxSweeps => "max-sweeps",
            Stop::Canceled => "canceled",
            Stop::NotFinite => "not-finite",
        }
    }
}

/// Decides after every sweep whether a run ends, from the base objective alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopRule {
    /// Value of the base objective below which the run ends. `None` without a goal.
    pub goal: Option<f64>,
    /// Estimated distance of f to its limit, relative to f, below which the run ends. 0 turns this test off.
    pub tolerance: f64,
    /// Largest number of sweeps, after which the run ends.
    pub max_sweeps: u32,
}

/// Relative change of f over a window below which f counts as constant up to rounding.
pub(crate) const NOISE: f64 = 1e-9;
/// Relative distance from the best f within which f has not become worse. Evaluations of f on a device have errors of
/// this size.
pub(crate) const JITTER: f64 = 1e-6;
/// Smallest value of f relative to which shares of f are computed. By some metrics, such as AREA, f may go to 0, where
/// rounding alone determines its last digits.
pub(crate) const MIN_SCALE: f64 = 1e-6;
/// Absolute decrease of f that counts as rounding. If f should be 0, as by AREA, rounding leaves the mean square of
/// relative errors of some 1e-16.
pub(crate) const ROUNDING: f64 = 1e-28;

impl StopRule {
    /// Returns the longer of the two windows, in sweeps, from which the remaining gain is estimated. Both windows are
    /// multiples of the scheme's period, so that sweeps by equal metrics are compared.
    pub fn window(scheme: &Scheme) -> u32 {
        8u32.next_multiple_of(2 * scheme.period())
    }

    /// Returns the reason why the run ends after the last sweep of `history`, or `None` if the run continues. `history`
    /// has the base objective before the first sweep and after each sweep. `best` is the index of the smallest entry,
    /// and `window` the result of [`Self::window`]. With an empty history, the run continues.
    ///
    /// `shaders/finish.wgsl` implements the same rule for runs that are judged on the device.
    pub fn judge(&self, history: &[f64], best: usize, window: usize) -> Option<Stop> {
        let (last, f) = (history.len().checked_sub(1)?, *history.last()?);
        if self.goal.is_some_and(|goal| f < goal) {
            return Some(Stop::Reached);
        }
        if last >= window.saturating_mul(2) && (self.goal.is_some() || self.tolerance > 0.0) {
            let scale = f.max(MIN_SCALE);
            let still = (history[last - window] - f).abs() <= NOISE * scale;
            if still || last.saturating_sub(best) >= 2 * window {
                // f no longer changes, or no longer improves. Without a goal, a constant f is convergence.
                let level =
                    still || history.get(best).is_some_and(|&best| f - best <= JITTER * scale);
                let done = level && self.goal.is_none();
                return Some(if done { Stop::Converged } else { Stop::Stalled });
            }
            if self.remaining(history, window).is_some_and(|left| left <= self.tolerance) {
                return Some(Stop::Converged);
            }
        }
        (last as u32 >= self.max_sweeps).then_some(Stop::MaxSweeps)
    }

    /// Estimates the gain that remains after the last sweep of `history`, as a share of f. The estimate is twice the
    /// remaining gain of a geometric decay, because the slowest modes do not show in a window. `None` if `history` is
    /// shorter than two windows, or if the gains do not decay.
    pub fn remaining(&self, history: &[f64], window: usize) -> Option<f64> {
        let last = history.len().checked_sub(1)?;
        if last < window.saturating_mul(2) {
            return None;
        }
        let of_windows = [window, window.div_ceil(2)].map(|w| self.remaining_over(history, w));
        of_windows[0].zip(of_windows[1]).map(|(long, short)| long.max(short))
    }

    /// Estimates the gain that remains as [`remaining`](Self::remaining) does, from a single window. `None` if `history`
    /// is shorter than two windows, or if the gains do not decay.
    pub(crate) fn remaining_over(&self, history: &[f64], window: usize) -> Option<f64> {
        let last = history.len().checked_sub(1)?;
        let start = last.checked_sub(window.saturating_mul(2))?;
        let gain = |from: usize, to: usize| history[from] - history[to];
        let left = remaining_gain(gain(start, last - window), gain(last - window, last));
        let left = 2.0 * left / history[last].max(MIN_SCALE);
        Some(left).filter(|left| left.is_finite())
    }

    /// Returns the gain that rounding errors of f may hide after a run that has converged because f is level, as a share
    /// of f. The gain is the difference of the largest and the smallest value in the last two windows, and at least the
    /// tolerance.
    pub(crate) fn level(&self, history: &[f64], window: usize) -> f64 {
        let start = history.len().saturating_sub(window.saturating_mul(2).saturating_add(1));
        let last = &history[start..];
        let most = last.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = last.iter().copied().fold(f64::INFINITY, f64::min);
        let spread = last.last().map_or(0.0, |f| (most - least) / f.max(MIN_SCALE));
        spread.max(self.tolerance)
    }
}

/// Returns the remaining gain of a geometric decay, given the gains of two successive windows. Infinite if the gains do
/// not decay.
fn remaining_gain(before: f64, gain: f64) -> f64 {
    if gain > 0.0 && gain < before { gain * gain / (before - gain) } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_history_is_not_over() {
        assert_eq!(rule(None, 1e-6).judge(&[], 0, 8), None);
        assert_eq!(rule(None, 1e-6).judge(&[1.0], 7, usize::MAX), None);
    }

    fn rule(goal: Option<f64>, tolerance: f64) -> StopRule {
        StopRule { goal, tolerance, max_sweeps: 1000 }
    }

    #[test]
    fn a_geometric_decay_ends_at_its_tolerance() {
        let history: Vec<f64> = (0..400).map(|k| 1.0 + 0.9f64.powi(k)).collect();
        let ends =
            (1..400).find(|&n| rule(None, 1e-6).judge(&history[..n], n - 1, 8).is_some()).unwrap();
        let left = history[ends - 1] - 1.0;
        assert!(left <= 1e-6 && left > 0.25e-6, "{left:e} left at the end");
    }

    #[test]
    fn a_fast_start_is_not_taken_for_convergence() {
        // A steep drop and then a slow decay, as from a strongly perturbed mesh.
        let slow = |k: i32| 1.0 + 100.0 * 0.1f64.powi(k) + 1e-2 * 0.99f64.powi(k);
        let history: Vec<f64> = (0..30).map(slow).collect();
        assert!((1..30).all(|n| rule(None, 1e-4).judge(&history[..n], n - 1, 8).is_none()));
    }

    #[test]
    fn a_drift_away_from_the_best_ends_as_stalled() {
        let history: Vec<f64> = (0..99).map(|k| 2.0 + (k as f64 / 99.0 - 0.2).abs()).collect();
        let ends = |n: &usize| rule(None, 1e-6).judge(&history[..*n], 20.min(n - 1), 8).is_some();
        assert_eq!((1..99).find(ends), Some(37));
        assert_eq!(rule(None, 1e-6).judge(&history[..37], 20, 8), Some(Stop::Stalled));
        assert_eq!(rule(None, 0.0).judge(&history[..37], 20, 8), None);
    }

    #[test]
    fn errors_of_single_precision_do_not_keep_a_run_going() {
        // The best value comes early and by chance, and later values jump around it.
        let jumps = |k: u32| f64::from(k * 7 % 5) * 1e-7;
        let history: Vec<f64> =
            (0..40).map(|k| 1.5 + if k == 4 { 0.0 } else { 1e-8 + jumps(k) }).collect();
        let at = |best: usize| rule(None, 1e-6).judge(&history[..21], best, 8);
        assert_eq!(at(4), Some(Stop::Converged));
        // No decay is left to extrapolate, but the jumps bound the gain.
        assert_eq!(rule(None, 1e-6).remaining(&history, 8), None);
        assert!((rule(None, 1e-9).level(&history, 8) - 4e-7 / 1.5).abs() < 1e-8);
        assert_eq!(rule(None, 1e-6).level(&history, 8), 1e-6);
        assert_eq!(rule(Some(1.0), 0.0).judge(&history[..21], 4, 8), Some(Stop::Stalled));
    }

    #[test]
    fn an_objective_that_goes_to_zero_converges() {
        let history: Vec<f64> =
            (0..60).map(|k| 0.1f64.powi(k) + f64::from(k % 3) * 1e-31).collect();
        let end = (1..60).find(|&n| rule(None, 1e-6).judge(&history[..n], n - 1, 8).is_some());
        assert!(end.is_some_and(|n| (17..25).contains(&n)), "{end:?}");
        let n = end.unwrap_or_default();
        assert_eq!(rule(None, 1e-6).judge(&history[..n], n - 1, 8), Some(Stop::Converged));
    }

    #[test]
    fn a_goal_out_of_reach_ends_as_stalled() {
        let history: Vec<f64> = (0..99).map(|k| 2.0 + 0.1f64.powi(k)).collect();
        assert_eq!(rule(Some(1.0), 0.0).judge(&history, 98, 8), Some(Stop::Stalled));
        assert_eq!(rule(Some(2.5), 0.0).judge(&history, 98, 8), Some(Stop::Reached));
        assert_eq!(rule(None, 1e-6).judge(&history, 98, 8), Some(Stop::Converged));
    }
}
