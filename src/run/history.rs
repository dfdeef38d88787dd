//! The history of a run: objectives after each sweep, and the reason of the run's end.

use crate::metric::Metric;
use crate::run::objectives::Objectives;
use crate::run::plan::Plan;
use crate::run::stop::{Stop, StopRule};

/// Objectives before the first sweep and after each sweep, with the stop rule applied to them.
#[derive(Clone, Debug)]
pub(crate) struct History {
    rule: StopRule,
    base: Metric,
    window: usize,
    log: Vec<Objectives>,
    /// Base objective of each entry of `log`.
    f: Vec<f64>,
    best: usize,
    stop: Option<Stop>,
    remaining: Option<f64>,
}

impl History {
    /// Creates an empty history of a run by `plan`.
    pub(crate) fn new(plan: &Plan) -> Self {
        Self {
            rule: plan.stop,
            base: plan.scheme.base(),
            window: StopRule::window(&plan.scheme) as usize,
            log: Vec::new(),
            f: Vec::new(),
            best: 0,
            stop: None,
            remaining: None,
        }
    }

    /// Creates the history of a run that continues, from the objectives so far and the estimate of the remaining gain.
    pub(crate) fn resumed(plan: &Plan, log: &[Objectives], remaining: Option<f64>) -> Self {
        let mut history = Self::new(plan);
        for objectives in log {
            history.add(*objectives);
        }
        history.remaining = remaining;
        history
    }

    /// Returns the first sweep with an infinite or NaN base objective, if any, from evaluation `known` on.
    pub(crate) fn first_not_finite(&self, known: usize) -> Option<u32> {
        (known..self.f.len()).find(|&k| !self.f[k].is_finite()).map(|k| k as u32)
    }

    /// Adds the objectives before the first sweep or after the next sweep, without the stop rule. Returns whether the
    /// base objective is the smallest so far.
    pub(crate) fn add(&mut self, objectives: Objectives) -> bool {
        let evaluation = self.f.len();
        let f = objectives.of(self.base).unwrap_or(f64::NAN);
        self.log.push(objectives);
        self.f.push(f);
        let is_best = evaluation == 0 || f < self.f[self.best];
        if is_best {
            self.best = evaluation;
        }
        is_best
    }

    /// Replaces the objectives after the last sweep by `now`. Replaces the objectives after sweep `from` + 1 and later
    /// sweeps too, if their base objective is smaller than that of `now`.
    pub(crate) fn replace_after(&mut self, from: u32, now: Objectives) {
        let (last, f) = (self.sweeps() as usize, now.of(self.base).unwrap_or(f64::NAN));
        for k in from as usize + 1..=last {
            if k == last || self.f[k] < f {
                (self.log[k], self.f[k]) = (now, f);
            }
        }
        self.best =
            (0..self.f.len()).fold(0, |best, k| if self.f[k] < self.f[best] { k } else { best });
    }

    /// Adds objectives like [`add`](Self::add), and applies the stop rule.
    pub(crate) fn record(&mut self, objectives: Objectives) -> bool {
        let is_best = self.add(objectives);
        self.stop = self.rule.judge(&self.f, self.best, self.window);
        self.remaining = self.rule.remaining(&self.f, self.window);
        if self.stop == Some(Stop::Converged) && self.remaining.is_none() {
            self.remaining = Some(self.rule.level(&self.f, self.window));
        }
        is_best
    }

    /// Sets the reason why the run has ended (`None` to continue), and the estimated remaining gain as a share of f.
    /// Callers that apply the stop rule themselves use this function.
    pub(crate) fn end(&mut self, stop: Option<Stop>, remaining: Option<f64>) {
        self.stop = stop;
        self.remaining = remaining;
    }

    /// Replaces the tolerance of the stop rule.
    pub(crate) fn set_tolerance(&mut self, tolerance: f64) {
        self.rule.tolerance = tolerance;
    }

    /// Returns whether the history has no entry yet.
    pub(crate) fn is_empty(&self) -> bool {
        self.f.is_empty()
    }

    /// Returns the number of recorded sweeps.
    pub(crate) fn sweeps(&self) -> u32 {
        (self.f.len() as u32).saturating_sub(1)
    }

    /// Returns the base objective before the first sweep and after each sweep.
    pub(crate) fn f(&self) -> &[f64] {
        &self.f
    }

    /// Returns the latest base objective; NaN for an empty history.
    pub(crate) fn last(&self) -> f64 {
        self.f.last().copied().unwrap_or(f64::NAN)
    }

    /// Returns the smallest base objective; NaN for an empty history.
    pub(crate) fn least(&self) -> f64 {
        self.f.get(self.best).copied().unwrap_or(f64::NAN)
    }

    /// Returns the tracked objectives before the first sweep and after each sweep.
    pub(crate) fn log(&self) -> &[Objectives] {
        &self.log
    }

    /// Returns the tracked objectives and drops all other data.
    pub(crate) fn into_log(self) -> Vec<Objectives> {
        self.log
    }

    /// Returns the stop rule of the run.
    pub(crate) fn rule(&self) -> StopRule {
        self.rule
    }

    /// Returns the reason why the run has ended. `None` while the run continues.
    pub(crate) fn stop(&self) -> Option<Stop> {
        self.stop
    }

    /// Returns the estimated remaining gain as a share of f. `None` without an estimate; see [`StopRule::remaining`].
    pub(crate) fn remaining(&self) -> Option<f64> {
        self.remaining
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::Options;

    /// A former defect: a run whose f was level, and did not decay, reported no remaining gain.
    #[test]
    fn a_level_f_is_convergence_with_the_variation_as_remaining_gain() {
        let mut history = History::new(&Plan::new(&Options::default()));
        for k in 0..40 {
            let mut objectives = Objectives::empty();
            let jump = if k % 5 == 3 { 3e-6 } else { 0.0 };
            objectives.set(history.base, if k == 4 { 2.0 } else { 2.0 + 1e-7 + jump });
            history.record(objectives);
        }
        assert_eq!(history.stop(), Some(Stop::Converged));
        let remaining = history.remaining().unwrap();
        assert!((remaining - 1.5e-6).abs() < 1e-9, "{remaining:e}");
    }
}
