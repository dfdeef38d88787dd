//! The desired objective of a goal: as given, or found by search runs.

use std::ops::ControlFlow::{self, Break, Continue};

use glam::DVec2;

use crate::cpu::objective;
use crate::error::SmoothError;
use crate::layout::Problem;
use crate::metric::{Metric, Scheme};
use crate::options::{Goal, Options, Stopping};
use crate::outcome::GoalOutcome;
use crate::run::{
    CheckpointPolicy, Checkpointer, NOISE, Observer, Phase, Plan, ROUNDING, Stop, set_guards,
};
use crate::slide::OnCurves;
use crate::whole::{Place, RunEnd, Session, Spec, drive};

use super::over_all::OverAll;
use super::prepared::Smoother;

/// The start of a search run: normalized positions, and the sliding vertices there.
#[derive(Clone)]
struct Start {
    positions: Vec<DVec2>,
    curves: Option<OnCurves>,
}

/// Returns the options of a search run by a metric.
fn to_convergence(options: &Options, metric: Metric) -> Options {
    Options {
        scheme: Scheme::from(metric),
        stopping: Stopping::Tolerance(1e-8),
        max_sweeps: 5000,
        guard: options.guard,
        ..Options::default()
    }
}

impl Smoother<'_> {
    /// Returns the goal of a run, with its desired objective over the triangles by which the run is judged; `None` for a run
    /// without a goal. `known` is the desired objective of a checkpoint, and its origin. If neither the checkpoint nor the
    /// options have a desired objective, runs to convergence determine it. Breaks if the observer ended a search run.
    pub(super) async fn resolve_goal(
        &self,
        over_all: &OverAll<'_>,
        options: &Options,
        known: Option<(f64, String)>,
        place: &Place<'_>,
        policy: &mut dyn CheckpointPolicy,
        observe: &mut dyn Observer,
    ) -> Result<ControlFlow<(), Option<GoalOutcome>>, SmoothError> {
        let problem = over_all.problem;
        let base = options.scheme.base();
        let Some(Goal { fraction, desired }) = options.stopping.goal() else {
            return Ok(Continue(None));
        };
        let given = || Some((over_all.judged(base, desired?), "given".to_owned()));
        let aimed = |(desired, origin)| {
            Continue(Some(GoalOutcome { fraction, desired, origin, best_fraction: 0.0 }))
        };
        if let Some(known) = known.or_else(given) {
            return Ok(aimed(known));
        }
        let full = |metric| to_convergence(options, metric);
        let start = problem.positions();
        let from_start = Start { positions: start.to_vec(), curves: self.on_curves(options) };
        let mut starts = vec![(format!("{base} alone"), from_start.clone())];
        if !base.properties().is_inverse_mean_ratio {
            let imr = Options { stopping: Stopping::Tolerance(1e-6), ..full(Metric::Imr) };
            let after_imr =
                self.search_reference(problem, &imr, &from_start, place, policy, observe).await?;
            if after_imr.stop == Stop::Canceled {
                return Ok(Break(()));
            }
            let RunEnd { positions, curves, .. } = after_imr;
            starts.push((format!("imr, then {base}"), Start { positions, curves }));
        }
        let mut describe = Vec::new();
        let mut desired = f64::INFINITY;
        for (label, start) in starts {
            let full = full(base);
            let end = self.search_reference(problem, &full, &start, place, policy, observe).await?;
            if end.stop == Stop::Canceled {
                return Ok(Break(()));
            }
            let f = objective(base, problem, &end.positions).await;
            let sweeps = end.history.len() - 1;
            let printed = over_all.f(base, f);
            describe
                .push(format!("{label}: {printed} after {sweeps} sweeps ({})", end.stop.name()));
            desired = desired.min(f);
        }
        // On an optimal mesh, search runs gain no more than rounding. The initial f is then the desired one.
        let initial = objective(base, problem, start).await;
        if initial - desired <= NOISE * initial + ROUNDING {
            desired = initial;
        }
        let origin = format!("runs to convergence; {}", describe.join("; "));
        Ok(aimed((desired, origin)))
    }

    /// Runs to convergence from the given start, with progress reported as [`Phase::Reference`].
    async fn search_reference(
        &self,
        problem: &Problem,
        options: &Options,
        start: &Start,
        place: &Place<'_>,
        policy: &mut dyn CheckpointPolicy,
        observe: &mut dyn Observer,
    ) -> Result<RunEnd, SmoothError> {
        let Start { positions, curves } = start;
        let mut plan = Plan::toward(options, None);
        set_guards(&mut plan, options.guard, problem, positions).await;
        let (phase, curves) = (Phase::Reference, curves.as_ref());
        let spec = Spec { problem, options, phase, from: positions, curves, resumed: None };
        let checkpointer = Checkpointer::new(policy, None);
        let run = Session::new(spec, plan, place.clone(), None, checkpointer).await?;
        drive(run, observe).await
    }
}
