//! Opening triangles that are too flat for single precision.
//!
//! In single precision the area of a triangle is wrong by about 1e-7 of the product of its sides, so one whose inverse mean
//! ratio is above a million may look inverted, and no step on a device can tell better from worse. A few sweeps in
//! double precision open it.

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

/// The largest inverse mean ratio that is left to a device, with room for what rounding does to areas.
const TOO_FLAT: f64 = 1e5;

/// Sweeps after which a triangle that is still flat will stay so.
const MOST_SWEEPS: u32 = 120;

/// Sweeps that opened the flat triangles.
pub(crate) struct Opened {
    history: History,
    /// The positions after the last.
    pub(crate) positions: Vec<DVec2>,
    /// The best positions by the base metric.
    best: Vec<DVec2>,
}

/// Whether a triangle is too flat for a device.
pub(crate) fn is_needed(problem: &Problem, positions: &[DVec2]) -> bool {
    let is_flat = |t: &[u32; 3]| {
        let [p, q, r] = t.map(|v| positions[v as usize]);
        let corner = Corner { a: (q - p).into(), b: (r - p).into(), mean_area: 1.0 };
        // A triangle of no area is infinite, and not to be opened: only an application has such.
        corner.inverse_mean_ratio() > TOO_FLAT
    };
    map_parts(problem.triangles().chunks(4096), |_, chunk| chunk.iter().any(is_flat))
        .contains(&true)
}

/// Sweeps of the plan by an engine in double precision, until no triangle is too flat, in whole periods of the scheme;
/// `None` if they do not get there, or the run ends before. Yields after each period.
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
    /// Sweeps done.
    pub(crate) fn sweeps(&self) -> u32 {
        self.history.sweeps()
    }

    /// The objectives and best positions of the whole, given those of what came after.
    pub(crate) fn followed_by(
        self,
        history: History,
        positions: Vec<DVec2>,
    ) -> (Vec<Objectives>, Vec<DVec2>) {
        let best = if self.history.least() < history.least() { self.best } else { positions };
        // What came after began with an evaluation of where this ended.
        let rest = history.into_log().into_iter().skip(1);
        (self.history.into_log().into_iter().chain(rest).collect(), best)
    }
}
