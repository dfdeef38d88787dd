//! Opening triangles that are too flat for single precision.
//!
//! In single precision the area of a triangle is wrong by about 1e-7 of the product of its sides, so one whose inverse mean
//! ratio is above a million may look inverted, and no step on a device can tell better from worse. A few sweeps in
//! double precision open it.

use glam::DVec2;
use rayon::prelude::*;

use crate::cpu::CpuEngine;
use crate::layout::Problem;
use crate::metric::{Corner, Metric};
use crate::run::Plan;
use crate::run::{Engine, Objectives};

/// The largest inverse mean ratio that is left to a device, with room for what rounding does to areas.
const TOO_FLAT: f64 = 1e5;

/// Sweeps after which a triangle that is still flat will stay so.
const MOST_SWEEPS: u32 = 120;

/// Sweeps that opened the flat triangles.
pub(crate) struct Opened {
    /// Objectives before the first sweep and after each.
    history: Vec<Objectives>,
    /// The positions after the last.
    pub(crate) positions: Vec<DVec2>,
    /// The best positions by the base metric.
    best: Vec<DVec2>,
}

/// Whether a triangle is too flat for a device.
pub(crate) fn is_needed(problem: &Problem, positions: &[DVec2]) -> bool {
    problem.triangles().par_iter().with_min_len(1024).any(|t| {
        let [p, q, r] = t.map(|v| positions[v as usize]);
        let corner = Corner { a: (q - p).into(), b: (r - p).into(), mean_area: 1.0 };
        // A triangle of no area is infinite, and not to be opened: only an application has such.
        Metric::Ar.quality(&corner) > TOO_FLAT
    })
}

/// Sweeps of the plan, in double precision, until no triangle is too flat, in whole periods of the scheme; `None` if they do
/// not get there, or the run ends before.
pub(crate) fn open(problem: &Problem, from: &[DVec2], plan: Plan) -> Option<Opened> {
    let period = plan.scheme.period();
    let mut engine = CpuEngine::new(problem, from.to_vec(), plan);
    let mut history = Vec::new();
    for _ in 0..MOST_SWEEPS.div_ceil(period) {
        history.extend(engine.advance(period).ok()?);
        if engine.stop().is_some() {
            return None;
        }
        if !is_needed(problem, engine.positions()) {
            let positions = engine.positions().to_vec();
            return Some(Opened { history, positions, best: engine.best_positions().ok()? });
        }
    }
    None
}

impl Opened {
    /// Sweeps done.
    pub(crate) fn sweeps(&self) -> u32 {
        self.history.len() as u32 - 1
    }

    /// The history and best positions of the whole, given those of what came after.
    pub(crate) fn followed_by(
        self,
        base: Metric,
        history: Vec<Objectives>,
        positions: Vec<DVec2>,
    ) -> (Vec<Objectives>, Vec<DVec2>) {
        let least = |history: &[Objectives]| {
            history.iter().filter_map(|o| o.of(base)).fold(f64::INFINITY, f64::min)
        };
        let better_before = least(&self.history) < least(&history);
        let best = if better_before { self.best } else { positions };
        // What came after began with an evaluation of where this ended.
        let rest = history.into_iter().skip(1);
        (self.history.into_iter().chain(rest).collect(), best)
    }
}
