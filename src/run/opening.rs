//! Opens triangles that are too flat or too small for a device.
//!
//! In single precision, the error of a triangle's area is about 1e-7 times the product of two sides. A triangle with an
//! inverse mean ratio above a million may look inverted, and a device cannot judge whether a step improves the
//! triangle. A few sweeps in double precision open such triangles first.
//!
//! A device stores positions as pairs of floats, with an error of 2^-48 of their size. If triangles of a strongly
//! graded mesh are hardly larger than this error, sweeps do not help, and the whole run is done in double precision.

use glam::DVec2;

use crate::error::GpuError;
use crate::layout::{CornerPart, Problem};
use crate::metric::{Corner, Ideal};
use crate::parallel::pace::pause;
use crate::parallel::paced;
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::objectives::Objectives;
use crate::run::plan::Plan;
use crate::run::sweeps;

/// Largest inverse mean ratio of a mesh for a device: a tenth of the ratio at which rounding may invert a triangle.
const TOO_FLAT: f64 = 1e5;

/// Largest rounding of positions on a device, as a share of a triangle's height.
const TOO_COARSE: f64 = 1e-4;
/// Rounding error of a pair of floats, relative to its value.
const PAIR_ROUNDING: f64 = 1.0 / (1u64 << 48) as f64;

/// Number of sweeps after which opening fails.
const MAX_SWEEPS: u32 = 120;

/// The state after sweeps in double precision, from which a device can continue.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DoublePrelude {
    /// Tracked objectives before the first sweep and after each sweep.
    pub(crate) log: Vec<Objectives>,
    /// Smallest base objective in `log`.
    pub(crate) least: f64,
    /// Normalized positions of all vertices after the last sweep.
    pub(crate) positions: Vec<DVec2>,
    /// Positions of all vertices with the smallest base objective.
    pub(crate) best: Vec<DVec2>,
}

/// The reason why a device cannot sweep a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Obstacle {
    None,
    /// A triangle is too flat. Sweeps in double precision may open it.
    Flat,
    /// A triangle is too small relative to its distance from the center.
    Small,
}

/// Returns the worst obstacle among all triangles and corners of quadrilaterals.
pub(crate) async fn obstacle(problem: &Problem, positions: &[DVec2]) -> Obstacle {
    let of = |t: &[u32; 3]| {
        let [p, q, r] = t.map(|v| positions[v as usize]);
        let corner = Corner { a: (q - p).into(), b: (r - p).into(), ideal: Ideal::of_area(1.0) };
        let rounding = PAIR_ROUNDING * p.abs().max_element();
        let (a, b) = ((q - p).length(), (r - p).length());
        // A height of a triangle is twice its area divided by an edge. The longer of two edges is never the shortest of
        // all three.
        if rounding > TOO_COARSE * a.max(b) {
            Obstacle::Small
        } else if corner.inverse_mean_ratio() > TOO_FLAT
            || rounding * a.max(b) > TOO_COARSE * corner.doubled_area()
        {
            // The ratio is infinite if the rounded area is not positive.
            Obstacle::Flat
        } else {
            Obstacle::None
        }
    };
    let worst = |_, part: CornerPart<'_>| part.corners.iter().map(of).max();
    let parts = problem.judged_parts().into_iter().flat_map(|part| part.chunks(4096));
    let worst = paced::map_parts(parts.collect::<Vec<_>>(), worst).await;
    worst.into_iter().flatten().max().unwrap_or(Obstacle::None)
}

/// Sweeps by an engine in double precision until no triangle is too flat or too small, in whole periods of the plan's
/// scheme. Returns `None` if such triangles are left after the last sweep, or if the run ends before.
pub(crate) async fn open(
    problem: &Problem,
    mut engine: impl Engine,
    plan: &Plan,
) -> Result<Option<DoublePrelude>, GpuError> {
    let period = plan.scheme.period();
    let mut history = History::new(plan);
    for _ in 0..MAX_SWEEPS.div_ceil(period) {
        sweeps::advance(&mut engine, plan, &mut history, period).await?;
        if history.stop().is_some() {
            return Ok(None);
        }
        if obstacle(problem, &engine.positions().await?).await == Obstacle::None {
            let positions = engine.positions().await?.into_owned();
            let (least, best) = (history.least(), engine.best_positions().await?);
            return Ok(Some(DoublePrelude { log: history.into_log(), least, positions, best }));
        }
        pause().await;
    }
    Ok(None)
}

impl DoublePrelude {
    /// Returns the number of completed sweeps.
    pub(crate) fn sweeps(&self) -> u32 {
        (self.log.len() as u32).saturating_sub(1)
    }

    /// Returns the log and the best positions of the whole run. `history` and `positions` come from the sweeps after
    /// the opening.
    pub(crate) fn followed_by(
        self,
        history: History,
        positions: Vec<DVec2>,
    ) -> (Vec<Objectives>, Vec<DVec2>) {
        let best = if self.least < history.least() { self.best } else { positions };
        // The first entry of the history repeats the last entry of the opening's log.
        let rest = history.into_log().into_iter().skip(1);
        (self.log.into_iter().chain(rest).collect(), best)
    }
}
