//! The desired objective of a goal: as given, or found by search runs.

use glam::DVec2;

use crate::error::SmoothError;
use crate::layout::Problem;
use crate::metric::{Metric, Scheme};
use crate::options::{Goal, Options, Stopping};
use crate::outcome::GoalOutcome;
use crate::run::{
    CheckpointPolicy, Checkpointer, NOISE, Observer, Phase, Plan, ROUNDING, Stop, set_guards,
};
use crate::slide::OnCurves;
use crate::whole::{Device, Live, RunEnd, Spec, drive};

use super::over_all::OverAll;
use super::prepared::{Smoother, objective};

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
    /// Returns the desired objective of a goal over the triangles by which the run is judged. If the goal has no desired
    /// objective, runs to convergence determine it. `None` if the observer ended a search run.
    pub(super) async fn resolve_goal(
        &self,
        over_all: &OverAll<'_>,
        goal: Goal,
        options: &Options,
        device: Option<Device<'_>>,
        policy: &mut dyn CheckpointPolicy,
        observe: &mut dyn Observer,
    ) -> Result<Option<GoalOutcome>, SmoothError> {
        let problem = over_all.problem;
        let Goal { fraction, desired } = goal;
        if let Some(desired) = desired {
            let origin = "given".to_owned();
            let desired = over_all.judged(options.scheme.base(), desired);
            return Ok(Some(GoalOutcome { fraction, desired, origin, best_fraction: 0.0 }));
        }
        let base = options.scheme.base();
        let full = |metric| to_convergence(options, metric);
        let start = problem.positions();
        let curves = self.on_curves(options);
        let from_start = Start { positions: start.to_vec(), curves };
        let mut starts = vec![(format!("{base} alone"), from_start.clone())];
        if !base.properties().is_inverse_mean_ratio {
            let imr = Options { stopping: Stopping::Tolerance(1e-6), ..full(Metric::Imr) };
            let after_imr =
                self.search_reference(problem, &imr, &from_start, device, policy, observe).await?;
            if after_imr.stop == Stop::Canceled {
                return Ok(None);
            }
            let RunEnd { positions, curves, .. } = after_imr;
            starts.push((format!("imr, then {base}"), Start { positions, curves }));
        }
        let mut describe = Vec::new();
        let mut desired = f64::INFINITY;
        for (label, start) in starts {
            let full = full(base);
            let end =
                self.search_reference(problem, &full, &start, device, policy, observe).await?;
            if end.stop == Stop::Canceled {
                return Ok(None);
            }
            let f = objective(problem, base, &end.positions).await;
            let sweeps = end.history.len() - 1;
            let printed = over_all.f(base, f);
            describe
                .push(format!("{label}: {printed} after {sweeps} sweeps ({})", end.stop.name()));
            desired = desired.min(f);
        }
        // On an optimal mesh, search runs gain no more than rounding. The initial f is then the desired one.
        let initial = objective(problem, base, start).await;
        if initial - desired <= NOISE * initial + ROUNDING {
            desired = initial;
        }
        let origin = format!("runs to convergence; {}", describe.join("; "));
        Ok(Some(GoalOutcome { fraction, desired, origin, best_fraction: 0.0 }))
    }

    /// Runs to convergence from the given start, with progress reported as [`Phase::Reference`].
    async fn search_reference(
        &self,
        problem: &Problem,
        options: &Options,
        start: &Start,
        device: Option<Device<'_>>,
        policy: &mut dyn CheckpointPolicy,
        observe: &mut dyn Observer,
    ) -> Result<RunEnd, SmoothError> {
        let Start { positions, curves } = start;
        let mut plan = Plan::toward(options, None);
        set_guards(&mut plan, options.guard, problem, positions).await;
        let device = device.filter(|_| !self.slides_on_cpu());
        let (phase, curves) = (Phase::Reference, curves.as_ref());
        let spec = Spec { problem, device, options, phase, has_field: false, curves };
        let mut checkpointer = Checkpointer::new(policy);
        let live = Live::new(spec, plan, positions, None, &mut checkpointer).await?;
        drive(live, None, &mut checkpointer, observe, None).await
    }
}
