//! Opening triangles that are too flat for single precision.
//!
//! In single precision the error of a triangle's area is about 1e-7 times the product of its sides. A triangle with an
//! inverse mean ratio above a million may look inverted, and a device cannot tell whether a step improves it. A few
//! sweeps in double precision open it first.

use glam::DVec2;

use crate::error::GpuError;
use crate::layout::Problem;
use crate::metric::Corner;
use crate::parallel::map_parts;
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::objectives::Objectives;
use crate::run::plan::Plan;
use crate::run::sweeps;
use crate::run::yielding::yield_now;

/// The largest inverse mean ratio that is left to a device. A tenth of the ratio at which rounding may invert a
/// triangle.
const TOO_FLAT: f64 = 1e5;

/// Number of sweeps after which opening is given up.
const MOST_SWEEPS: u32 = 120;

/// The result of sweeps that opened all flat triangles.
pub(crate) struct Opened {
    history: History,
    /// The positions after the last sweep.
    pub(crate) positions: Vec<DVec2>,
    /// The best positions by the base metric.
    best: Vec<DVec2>,
}

/// Whether a triangle is too flat for a device.
pub(crate) fn is_needed(problem: &Problem, positions: &[DVec2]) -> bool {
    let is_flat = |t: &[u32; 3]| {
        let [p, q, r] = t.map(|v| positions[v as usize]);
        let corner = Corner { a: (q - p).into(), b: (r - p).into(), mean_area: 1.0 };
        // Infinite if the rounded area is not positive.
        corner.inverse_mean_ratio() > TOO_FLAT
    };
    map_parts(problem.triangles().chunks(4096), |_, chunk| chunk.iter().any(is_flat))
        .contains(&true)
}

/// Sweeps by an engine in double precision until no triangle is too flat, in whole periods of the plan's scheme.
/// Returns `None` if a triangle stays too flat, or if the run ends before. Yields after each period.
pub(crate) async fn open(
    problem: &Problem,
    mut engine: impl Engine,
    plan: &Plan,
) -> Result<Option<Opened>, GpuError> {
    let period = plan.scheme.period();
    let mut history = History::new(plan);
    for _ in 0..MOST_SWEEPS.div_ceil(period) {
        sweeps::advance(&mut engine, plan, &mut history, period).await?;
        if history.stop().is_some() {
            return Ok(None);
        }
        if !is_needed(problem, &engine.positions().await?) {
            let positions = engine.positions().await?.into_owned();
            return Ok(Some(Opened { history, positions, best: engine.best_positions().await? }));
        }
        yield_now().await;
    }
    Ok(None)
}

impl Opened {
    /// Number of sweeps done.
    pub(crate) fn sweeps(&self) -> u32 {
        self.history.sweeps()
    }

    /// The objectives and best positions of the whole run, given those of the sweeps after the opening.
    pub(crate) fn followed_by(
        self,
        history: History,
        positions: Vec<DVec2>,
    ) -> (Vec<Objectives>, Vec<DVec2>) {
        let best = if self.history.least() < history.least() { self.best } else { positions };
        // The first entry evaluates the positions at which the opening ended, which are in its history already.
        let rest = history.into_log().into_iter().skip(1);
        (self.history.into_log().into_iter().chain(rest).collect(), best)
    }
}
