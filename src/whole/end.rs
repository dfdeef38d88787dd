//! The end of a run: its positions, counts, and the reason of the end.

use glam::DVec2;

use crate::cpu::held_back;
use crate::layout::Problem;
use crate::options::Guard;
use crate::outcome::DeviceFault;
use crate::run::{Counts, Objectives, Plan, Stop};
use crate::slide::OnCurves;
use crate::whole::session::Session;

/// The result of a run's sweeps: positions, history, counts, and the reason of the end.
pub(crate) struct RunEnd {
    pub(crate) history: Vec<Objectives>,
    pub(crate) positions: Vec<DVec2>,
    /// The sliding vertices at these positions. `None` if no vertex slides.
    pub(crate) curves: Option<OnCurves>,
    pub(crate) counts: Counts,
    /// Number of sweeps on the CPU before the device, or of all sweeps if the device was unfit from the start.
    pub(crate) opening_sweeps: u32,
    /// Number of sweeps on the CPU after the device had become unfit.
    pub(crate) closing_sweeps: u32,
    pub(crate) remaining: Option<f64>,
    pub(crate) held_back: usize,
    pub(crate) stop: Stop,
    pub(crate) fault: Option<DeviceFault>,
}

impl RunEnd {
    /// Ends a run for the reason `stop`, with the vertices at `positions`.
    pub(crate) async fn of(run: Session<'_>, positions: Vec<DVec2>, mut stop: Stop) -> Self {
        let held_back = held_by_guard(run.problem(), &run.plan, &positions, stop).await;
        let is_held = held_back > 0 && run.spec.options.guard == Guard::ByMetric;
        if is_held && stop == Stop::Converged {
            stop = Stop::HeldBack;
        }
        let (opened, sweeps) = (run.opening_sweeps(), run.history.sweeps());
        let from = run.place.unfit_from();
        let on_cpu = from.map_or(0, |from| sweeps.saturating_sub(from));
        let (opening_sweeps, closing_sweeps) = match from {
            Some(1..) => (opened, on_cpu),
            _ => (opened + on_cpu, 0),
        };
        let counts = run.course.counts(sweeps);
        let Session { history, opened: prelude, spec, curves, given, place, .. } = run;
        let remaining = history.remaining();
        // The sweeps that opened triangles moved no vertex along a curve.
        let is_from_opening =
            prelude.as_ref().is_some_and(|prelude| prelude.least < history.least());
        let curves = if is_from_opening { spec.curves.cloned() } else { curves };
        let (mut history, positions) = match prelude {
            Some(prelude) => prelude.followed_by(history, positions),
            None => (history.into_log(), positions),
        };
        if let Some(given) = given {
            // The move to means of neighbors belongs to the first sweep. Without sweeps, the move counts as a sweep.
            match history.len() {
                1 => history.insert(0, given),
                _ => history[0] = given,
            }
        }
        Self {
            history,
            positions,
            curves,
            counts: Counts { alternated: opened + counts.alternated, ..counts },
            opening_sweeps,
            closing_sweeps,
            remaining,
            held_back,
            stop,
            fault: place.fault(),
        }
    }
}

/// Returns the number of vertices that a guard of triangles holds at the end of a run.
async fn held_by_guard(problem: &Problem, plan: &Plan, positions: &[DVec2], stop: Stop) -> usize {
    let step = plan.base_step(1.0);
    let can_be_held = matches!(stop, Stop::Converged | Stop::MaxSweeps);
    match can_be_held && step.shape_guard.is_finite() && problem.free_count() > 0 {
        true => held_back(problem, positions, &step).await,
        false => 0,
    }
}
