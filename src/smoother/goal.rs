//! The desired objective of a goal.

use crate::error::SmoothError;
use crate::metric::{Metric, Scheme};
use crate::outcome::GoalOutcome;
use crate::run::{Desired, Goal, Keeper, Keeping, NOISE, Observer, Options, Phase, ROUNDING, Stop};
use crate::whole::{Attempt, Device};

use super::prepared::Smoother;

impl Smoother<'_> {
    /// Returns the desired objective of a goal. If it is not given, finds it by runs to convergence; `None` if the
    /// observer ended one of them.
    pub(super) async fn aim<K: Keeper + ?Sized>(
        &self,
        goal: Goal,
        options: &Options,
        device: Option<Device<'_>>,
        keeper: &mut K,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Option<GoalOutcome>, SmoothError> {
        let Goal { fraction, desired } = goal;
        if let Desired::Value(desired) = desired {
            let origin = "given".to_owned();
            return Ok(Some(GoalOutcome { fraction, desired, origin, best_fraction: 0.0 }));
        }
        let base = options.scheme.base();
        let full = |metric: Metric| Options {
            scheme: Scheme::from(metric),
            tolerance: 1e-8,
            max_sweeps: 5000,
            guard: options.guard,
            ..Options::default()
        };
        let run = Attempt { problem: &self.problem, device, phase: Phase::Reference, done: 0 };
        let start = self.problem.positions();
        let mut starts = vec![(format!("{base} alone"), start.to_vec())];
        if !base.properties().is_inverse_mean_ratio {
            let imr = Options { tolerance: 1e-6, ..full(Metric::Imr) };
            let mut keeping = Keeping::new(&mut *keeper);
            let after_imr = run.sweep(&imr, None, start, None, &mut keeping, observe).await?;
            if after_imr.stop == Stop::Canceled {
                return Ok(None);
            }
            starts.push((format!("imr, then {base}"), after_imr.positions));
        }
        let mut describe = Vec::new();
        let mut desired = f64::INFINITY;
        for (label, start) in starts {
            let (options, mut keeping) = (full(base), Keeping::new(&mut *keeper));
            let end = run.sweep(&options, None, &start, None, &mut keeping, observe).await?;
            if end.stop == Stop::Canceled {
                return Ok(None);
            }
            let f = self.objective(base, &end.positions);
            let sweeps = end.history.len() - 1;
            describe.push(format!("{label}: {f} after {sweeps} sweeps ({})", end.stop.name()));
            desired = desired.min(f);
        }
        // On an optimal mesh, what these runs gain is rounding. The first f is then the desired one.
        let initial = self.objective(base, start);
        if initial - desired <= NOISE * initial + ROUNDING {
            desired = initial;
        }
        let origin = format!("runs to convergence; {}", describe.join("; "));
        Ok(Some(GoalOutcome { fraction, desired, origin, best_fraction: 0.0 }))
    }
}
