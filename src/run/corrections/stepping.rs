//! The Newton steps of all vertices at the end of a run, and the return to sweeps if the steps stay short.

use super::plan_steps::OMEGA_BETWEEN;
use super::state::{Corrections, Stage};
use crate::error::GpuError;
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::objectives::Objectives;
use crate::run::progress::GoesOn;
use crate::run::stop::{MIN_SCALE, NOISE, Stop};
use crate::run::truncated::Tail;

/// Number of sweeps alone, after steps that stay short, before corrections or steps begin again.
const SWEEPS_AFTER: usize = 5;
/// Number of times that steps begin, if vertices slide and no guard holds triangles.
const MOST_BEGINNINGS: u32 = 5;

impl Corrections {
    /// Sweeps once, and takes a Newton step of all vertices. `None`, and nothing happens, on an engine that takes none.
    pub(super) async fn sweep_and_step(
        &mut self,
        engine: &mut impl Engine,
        history: &History,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<Option<Objectives>, GpuError> {
        let objective = history.last().max(MIN_SCALE);
        let request = self.tail.request(objective, history.rule().tolerance);
        let sweep = self.step(OMEGA_BETWEEN);
        let Some(step) = engine.sweep_and_step(&sweep, &request, goes_on).await? else {
            return Ok(None);
        };
        let f = step.excess + self.metric().ideal_squared();
        let tolerance = history.rule().tolerance;
        let (left, is_whole) = self.tail.record(&step, f.max(MIN_SCALE), tolerance, engine.noise());
        let above = [history.last(), f].map(|f| f - self.least);
        match self.tail.is_stuck(&step, is_whole, above) {
            true => self.leave_steps(step.slides, history.f().len()),
            false => self.stage = Stage::Stepping { left },
        }
        if self.plan.track_all || !self.plan.is_monotone() {
            return Ok(Some(engine.objectives().await?));
        }
        let mut objectives = Objectives::empty();
        objectives.set(self.metric(), f);
        Ok(Some(objectives))
    }

    /// Goes back to sweeps alone after `done` evaluations. Steps begin again if vertices slide, as corrections leave sliding
    /// vertices where they are. A guard that binds shortens all later steps too, so corrections follow.
    fn leave_steps(&mut self, slides: bool, done: usize) {
        let is_guarded = self.step(1.0).shape_guard.is_finite();
        self.can_step = slides && !is_guarded && self.attempts < MOST_BEGINNINGS;
        self.stage = Stage::Before { until: done + SWEEPS_AFTER };
    }

    /// Applies the stop rule of a run that takes Newton steps: the run has converged once the gain that remains is within
    /// the tolerance. `of_f` is the reason for which f or the number of sweeps ends the run.
    pub(super) fn judge_step(&self, left: Option<f64>, of_f: Option<Stop>, history: &mut History) {
        let rule = history.rule();
        let scale = history.last().max(MIN_SCALE);
        let at_most = ((history.last() - self.least) / scale).max(NOISE);
        let at_most = Some(at_most).filter(|left| *left <= rule.tolerance);
        let remaining = left.into_iter().chain(at_most).reduce(f64::min);
        let is_within = |limit: f64| remaining.is_some_and(|left| left <= limit);
        let end = match rule.goal {
            _ if rule.tolerance > 0.0 && is_within(Tail::tolerance(rule.tolerance)) => {
                Some(Stop::Converged)
            }
            Some(_) if is_within(NOISE) => Some(Stop::Stalled),
            _ => None,
        };
        let stop = if of_f == Some(Stop::Reached) { of_f } else { end.or(of_f) };
        history.end(stop, remaining);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::Metric;
    use crate::options::Options;
    use crate::run::Plan;
    use crate::run::truncated::fixtures::{lattice, problem};

    /// A former defect: a coast on which two steps stayed short took 1,000 sweeps with corrections, which move no sliding vertex.
    #[test]
    fn steps_begin_again_where_vertices_slide_and_no_guard_holds_triangles() {
        let problem = problem(&lattice(5, 1.0));
        let goes_on = |metric: Metric, slides: bool, attempts: u32| {
            let plan = Plan::new(&Options { scheme: metric.into(), ..Options::default() });
            let mut corrections = Corrections::new(&problem, &plan, false);
            assert!(corrections.can_step);
            (corrections.stage, corrections.attempts) = (Stage::Stepping { left: None }, attempts);
            corrections.leave_steps(slides, 7);
            assert!(matches!(corrections.stage, Stage::Before { until: 12 }));
            corrections.can_step
        };
        assert!(goes_on(Metric::Imr, true, 1) && goes_on(Metric::Imr, true, MOST_BEGINNINGS - 1));
        assert!(!goes_on(Metric::Imr, true, MOST_BEGINNINGS));
        assert!(!goes_on(Metric::Imr, false, 1) && !goes_on(Metric::Rms, true, 1));
    }
}
