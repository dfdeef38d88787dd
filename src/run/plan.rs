//! What a run does, independent of the engine: the metric, relaxation and stopping of each sweep.

use crate::metric::Metric;
use crate::metric::Scheme;

/// How a metric is differentiated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Derivatives {
    /// Exactly, by formulas that tests hold against dual numbers.
    #[default]
    Analytic,
    /// By forward differences of the value, 16 evaluations an element, as Mesquite differentiates
    /// a metric that has no derivatives of its own (Park & Shontz's EDGE, AREA and RMS). Slower
    /// and no better: here to test the paper's cost model.
    FiniteDifference,
}

/// Newton on EDGE works on a p-norm with exponent k = 2^sharpness; this says which k each sweep uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Sharpness {
    /// log2 k of the first sweep.
    pub first: u32,
    /// k doubles after this many sweeps; 0 keeps it.
    pub every: u32,
    /// log2 of the largest k.
    pub last: u32,
}

impl Sharpness {
    /// k = 16 throughout: good after a few sweeps.
    pub const FIXED: Self = Self { first: 4, every: 0, last: 4 };
    /// k from 2 to 512, doubling every 5 sweeps: the best optimum, over more sweeps.
    pub const CONTINUED: Self = Self { first: 1, every: 5, last: 9 };

    /// The largest log2 k: beyond it even the ratio nearest to one vanishes in single precision.
    pub const MOST: u32 = 10;

    /// log2 k of a sweep; sweeps count from 1.
    pub fn of(self, sweep: u32) -> u32 {
        let doublings = sweep.saturating_sub(1).checked_div(self.every).unwrap_or(0);
        self.first.saturating_add(doublings).min(self.last.max(self.first))
    }
}

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stop {
    /// The base objective passed the asked fraction of the way to the desired value.
    Reached,
    /// What is left to gain is estimated below the tolerance.
    Converged,
    /// The base objective no longer improves: a goal is not reached, or an alternating scheme has
    /// drifted away from the base metric's optimum.
    Stalled,
    /// The largest number of sweeps was done.
    MaxSweeps,
    /// The caller's progress callback asked for it.
    Cancelled,
}

impl Stop {
    /// Codes of the reasons the device can find, injected into finish.wgsl; 0 is to go on.
    pub(crate) const CODES: [(Stop, u32); 4] =
        [(Stop::Reached, 1), (Stop::Converged, 2), (Stop::Stalled, 3), (Stop::MaxSweeps, 4)];

    pub(crate) fn from_code(code: u32) -> Option<Self> {
        Self::CODES.iter().find(|&&(_, c)| c == code).map(|&(stop, _)| stop)
    }

    /// A word for reports.
    pub fn name(self) -> &'static str {
        match self {
            Stop::Reached => "reached",
            Stop::Converged => "converged",
            Stop::Stalled => "stalled",
            Stop::MaxSweeps => "max-sweeps",
            Stop::Cancelled => "cancelled",
        }
    }
}

/// When a run ends, judged after every sweep on the base objective alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopRule {
    /// The run is done when the base objective is below this.
    pub target: Option<f64>,
    /// The run is done when the estimated distance to the limit, relative to f, is below this; 0
    /// never is.
    pub tolerance: f64,
    /// The run ends after this many sweeps.
    pub max_sweeps: u32,
}

/// A change of f over a window below this share of f is rounding, not progress.
pub(crate) const NOISE: f64 = 1e-9;

impl StopRule {
    /// The longer of the two windows the remaining distance is estimated from, in sweeps: a
    /// multiple of the scheme's period, so that like is compared with like.
    pub fn window(scheme: &Scheme) -> u32 {
        8u32.next_multiple_of(2 * scheme.period())
    }

    /// Judges after the last sweep of `history`, the base objective before the first sweep and
    /// after each. `best` is the sweep with the least of them. The same rule as in
    /// `shaders/finish.wgsl`.
    pub fn judge(&self, history: &[f64], best: usize, window: usize) -> Option<Stop> {
        let last = history.len() - 1;
        let f = history[last];
        if self.target.is_some_and(|target| f < target) {
            return Some(Stop::Reached);
        }
        if last >= 2 * window && (self.target.is_some() || self.tolerance > 0.0) {
            let gain = |from: usize, to: usize| history[from] - history[to];
            let still = gain(last - window, last).abs() <= NOISE * f;
            if still || last - best >= 2 * window {
                // Nothing happens any more. Without a goal that is what was asked for.
                let done = still && self.target.is_none();
                return Some(if done { Stop::Converged } else { Stop::Stalled });
            }
            let remaining =
                |w: usize| remaining_gain(gain(last - 2 * w, last - w), gain(last - w, last));
            // Twice the estimate, as slow modes outlast those that a window sees.
            if 2.0 * remaining(window).max(remaining(window.div_ceil(2))) <= self.tolerance * f {
                return Some(Stop::Converged);
            }
        }
        (last as u32 >= self.max_sweeps).then_some(Stop::MaxSweeps)
    }
}

/// What a geometric decay would still gain, from the gains of two successive windows; infinite where
/// these are none.
fn remaining_gain(before: f64, gain: f64) -> f64 {
    if gain > 0.0 && gain < before { gain * gain / (before - gain) } else { f64::INFINITY }
}

/// Everything both engines need to know to do the same sweeps.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The metric of each sweep.
    pub scheme: Scheme,
    /// Over-relaxation by metric, in the order of [`Metric::ALL`].
    pub omega: [f64; Metric::ALL.len()],
    /// Sweeps before over-relaxation starts.
    pub plain_sweeps: u32,
    /// The most Newton steps per visit of a vertex.
    pub inner: u32,
    /// How each metric is differentiated, in the order of [`Metric::ALL`].
    pub derivatives: [Derivatives; Metric::ALL.len()],
    /// The exponent of EDGE's p-norm.
    pub sharpness: Sharpness,
    /// When to end.
    pub stop: StopRule,
    /// Whether the history holds every metric's objective, not the base's alone.
    pub track_all: bool,
}

impl Plan {
    /// The relaxation factor of a sweep with `metric`; sweeps count from 1.
    pub fn omega(&self, metric: Metric, sweep: u32) -> f64 {
        if sweep <= self.plain_sweeps { 1.0 } else { self.omega[metric as usize] }
    }

    /// Whether every sweep lowers the base objective, so that the last state is the best. Differences
    /// promise nothing: their minimum is a little off.
    pub fn is_monotone(&self) -> bool {
        let base = self.scheme.base();
        self.scheme.is_monotone() && self.derivatives[base as usize] == Derivatives::Analytic
    }

    /// The metrics whose objective is evaluated after each sweep.
    pub fn tracked(&self) -> Vec<Metric> {
        if self.track_all { Metric::ALL.to_vec() } else { vec![self.scheme.base()] }
    }
}

/// Line-search and step constants common to both engines, injected into WGSL by `gpu::shaders`.
pub(crate) mod line_search {
    /// Share of the predicted decrease that must be had (Armijo).
    pub(crate) const SUFFICIENT_DECREASE: f64 = 1e-4;
    /// What rounding in single precision may add to a patch's objective, relative to the sum of q².
    /// The f64 engine grants it too, so that both accept the same steps.
    pub(crate) const SLACK: f64 = 1e-6;
    /// Trials before the vertex is left where it is.
    pub(crate) const TRIALS: u32 = 8;
    /// Shortening after a trial that inverts a triangle or breaks the shape guard.
    pub(crate) const SHORTEN_INFEASIBLE: f64 = 0.25;
    /// Shortening after a trial that does not decrease the objective enough.
    pub(crate) const SHORTEN: f64 = 0.5;
    /// Share of the shape guard kept in reserve, so that a triangle let through in single precision is
    /// within the guard in exact arithmetic as well.
    pub(crate) const GUARD_RESERVE: f64 = 1e-3;
    /// A visit of several steps ends with one shorter than this share of an edge of the patch. Not so by
    /// differences: their gradient does not vanish where the objective is least, and Mesquite, which
    /// they imitate, goes on to the last step it is granted.
    pub(crate) const SETTLED: f64 = 1e-4;
    /// Step of forward differences, relative to the vertex's least height over a ring edge. Large
    /// enough for the second differences to survive single precision.
    pub(crate) const DIFFERENCE: f64 = 1e-2;
    /// The 16 displacements of Mesquite's forward differences, in steps: the value and the three
    /// first differences at the vertex, and the same again one step along each axis. A planar
    /// mesh has no use for those along z, but they are paid for all the same.
    pub(crate) const DISPLACEMENTS: [[u32; 2]; 16] = [
        [0, 0],
        [1, 0],
        [0, 1],
        [0, 0],
        [1, 0],
        [2, 0],
        [1, 1],
        [1, 0],
        [0, 1],
        [1, 1],
        [0, 2],
        [0, 1],
        [0, 0],
        [1, 0],
        [0, 1],
        [0, 0],
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sharpness_doubles_k_up_to_the_last() {
        let of = |k| Sharpness::CONTINUED.of(k);
        assert_eq!([of(1), of(5), of(6), of(40), of(41), of(1000)], [1, 1, 2, 8, 9, 9]);
        assert_eq!([Sharpness::FIXED.of(1), Sharpness::FIXED.of(99)], [4, 4]);
    }

    fn rule(target: Option<f64>, tolerance: f64) -> StopRule {
        StopRule { target, tolerance, max_sweeps: 1000 }
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
        // A steep drop, then a slow decay: what a strongly perturbed mesh does.
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
    fn a_goal_out_of_reach_ends_as_stalled() {
        let history: Vec<f64> = (0..99).map(|k| 2.0 + 0.1f64.powi(k)).collect();
        assert_eq!(rule(Some(1.0), 0.0).judge(&history, 98, 8), Some(Stop::Stalled));
        assert_eq!(rule(Some(2.5), 0.0).judge(&history, 98, 8), Some(Stop::Reached));
        assert_eq!(rule(None, 1e-6).judge(&history, 98, 8), Some(Stop::Converged));
    }
}
