//! The objectives of a run so far, and whether it is over.

use crate::metric::Metric;
use crate::run::objectives::Objectives;
use crate::run::plan::Plan;
use crate::run::stop::{Stop, StopRule};

/// The objectives before the first sweep and after each, the best of them, and the reason why the run has ended, if it
/// has.
#[derive(Clone, Debug)]
pub(crate) struct History {
    rule: StopRule,
    base: Metric,
    window: usize,
    log: Vec<Objectives>,
    /// The base objective of each entry of `log`.
    f: Vec<f64>,
    best: usize,
    stop: Option<Stop>,
    remaining: Option<f64>,
}

impl History {
    /// Makes an empty history of a run by `plan`.
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

    /// Makes the history of a run that continues, from the objectives so far and the share of f that is estimated to be
    /// left.
    pub(crate) fn resumed(plan: &Plan, log: &[Objectives], remaining: Option<f64>) -> Self {
        let mut history = Self::new(plan);
        for objectives in log {
            history.add(*objectives);
        }
        history.remaining = remaining;
        history
    }

    /// Returns the first sweep after `known` evaluations after which the base objective is not finite, if there is one.
    pub(crate) fn first_not_finite(&self, known: usize) -> Option<u32> {
        (known..self.f.len()).find(|&k| !self.f[k].is_finite()).map(|k| k as u32)
    }

    /// Adds the objectives before the first sweep or after the next one, without applying the stop rule. Returns
    /// whether the base objective is the least so far.
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

    /// Replaces the objectives after the last sweep by `now`, and those after earlier sweeps than that, down to sweep `from` + 1,
    /// if they are lower.
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

    /// Adds objectives as [`add`](Self::add) does, and applies the stop rule.
    pub(crate) fn record(&mut self, objectives: Objectives) -> bool {
        let is_best = self.add(objectives);
        self.stop = self.rule.judge(&self.f, self.best, self.window);
        self.remaining = self.rule.remaining(&self.f, self.window);
        is_best
    }

    /// Sets the reason why the run has ended, if it has, and the share of f that is estimated to be left. For callers
    /// that apply the stop rule themselves.
    pub(crate) fn end(&mut self, stop: Option<Stop>, remaining: Option<f64>) {
        self.stop = stop;
        self.remaining = remaining;
    }

    /// Whether nothing has been recorded yet.
    pub(crate) fn is_empty(&self) -> bool {
        self.f.is_empty()
    }

    /// Returns the number of sweeps recorded.
    pub(crate) fn sweeps(&self) -> u32 {
        (self.f.len() as u32).saturating_sub(1)
    }

    /// Returns the base objective before the first sweep and after each.
    pub(crate) fn f(&self) -> &[f64] {
        &self.f
    }

    /// Returns the latest base objective; NaN if none is recorded.
    pub(crate) fn last(&self) -> f64 {
        self.f.last().copied().unwrap_or(f64::NAN)
    }

    /// Returns the least base objective; NaN if none is recorded.
    pub(crate) fn least(&self) -> f64 {
        self.f.get(self.best).copied().unwrap_or(f64::NAN)
    }

    /// Returns all objectives, before the first sweep and after each.
    pub(crate) fn log(&self) -> &[Objectives] {
        &self.log
    }

    /// Returns all objectives and drops the rest.
    pub(crate) fn into_log(self) -> Vec<Objectives> {
        self.log
    }

    /// Returns the stop rule of the run.
    pub(crate) fn rule(&self) -> StopRule {
        self.rule
    }

    /// Returns the reason why the run has ended, if it has.
    pub(crate) fn stop(&self) -> Option<Stop> {
        self.stop
    }

    /// Returns the share of f that is estimated to be left to gain; `None` if there is no estimate. See
    /// [`StopRule::remaining`].
    pub(crate) fn remaining(&self) -> Option<f64> {
        self.remaining
    }
}
