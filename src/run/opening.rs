//! Opens triangles that are too flat or too small for a device.
//!
//! In single precision the error of a triangle's area is about 1e-7 times the product of its sides. A triangle with an
//! inverse mean ratio above a million may look inverted, and a device cannot tell whether a step improves it. A few
//! sweeps in double precision open it first.
//!
//! A device stores positions as pairs of floats, with an error of 2^-48 of their size. If triangles of a strongly
//! graded mesh are hardly larger than that, sweeps do not help, and the whole run is done in double precision.

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

/// The largest inverse mean ratio that a device is given. It is a tenth of the ratio at which rounding may invert a
/// triangle.
const TOO_FLAT: f64 = 1e5;

/// The largest rounding of positions on a device, as a share of a triangle's height.
const TOO_COARSE: f64 = 1e-4;
/// The rounding of a pair of floats, relative to its value.
const PAIR_ROUNDING: f64 = 1.0 / (1u64 << 48) as f64;

/// Number of sweeps after which opening ends without success.
const MOST_SWEEPS: u32 = 120;

/// The state after sweeps in double precision, from which a device can continue.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Opened {
    /// The objectives before the first sweep and after each.
    pub(crate) log: Vec<Objectives>,
    /// The least base objective among them.
    pub(crate) least: f64,
    /// The positions after the last sweep.
    pub(crate) positions: Vec<DVec2>,
    /// The best positions by the base metric.
    pub(crate) best: Vec<DVec2>,
}

/// The reason why a device cannot sweep a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Obstacle {
    None,
    /// A triangle is too flat, which sweeps in double precision may repair.
    Flat,
    /// A triangle is too small for its distance from the center.
    Small,
}

/// Returns the worst obstacle of all triangles.
pub(crate) fn obstacle(problem: &Problem, positions: &[DVec2]) -> Obstacle {
    let of = |t: &[u32; 3]| {
        let [p, q, r] = t.map(|v| positions[v as usize]);
        let corner = Corner { a: (q - p).into(), b: (r - p).into(), mean_area: 1.0 };
        let rounding = PAIR_ROUNDING * p.abs().max_element();
        let (a, b) = ((q - p).length(), (r - p).length());
        // A height is the doubled area divided by an edge. The larger of these two edges is never the shortest of the
        // three.
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
    let worst = |_, chunk: &[[u32; 3]]| chunk.iter().map(of).max().unwrap_or(Obstacle::None);
    let worst = map_parts(problem.triangles().chunks(4096), worst).into_iter().max();
    worst.unwrap_or(Obstacle::None)
}

/// Sweeps, by an engine in double precision, until no triangle is too flat or too small, in whole periods of the plan's
/// scheme. Returns `None` if a triangle stays so, or if the run ends before. Yields after each period.
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
        if obstacle(problem, &engine.positions().await?) == Obstacle::None {
            let positions = engine.positions().await?.into_owned();
            let (least, best) = (history.least(), engine.best_positions().await?);
            return Ok(Some(Opened { log: history.into_log(), least, positions, best }));
        }
        yield_now().await;
    }
    Ok(None)
}

impl Opened {
    /// Returns the number of sweeps done.
    pub(crate) fn sweeps(&self) -> u32 {
        (self.log.len() as u32).saturating_sub(1)
    }

    /// Combines the opening with the sweeps after it, given their history and best positions, to those of the whole
    /// run.
    pub(crate) fn followed_by(
        self,
        history: History,
        positions: Vec<DVec2>,
    ) -> (Vec<Objectives>, Vec<DVec2>) {
        let best = if self.least < history.least() { self.best } else { positions };
        // The first entry is for the positions at which the opening ended, which are in its history already.
        let rest = history.into_log().into_iter().skip(1);
        (self.log.into_iter().chain(rest).collect(), best)
    }
}
