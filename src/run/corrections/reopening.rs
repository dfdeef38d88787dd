//! Reopens triangles that lie flat where EDGE's p-norm with a low exponent is least.
//!
//! EDGE has no barrier, and a flat triangle whose three edges are long is cheap by it. A mesh that was untangled, or has a few vertices
//! out of place, may have such triangles in a minimum of their own, a few percent above the next one, which they do not leave: as the
//! exponent grows they are flattened up to the shape guard. Where flat triangles are good by EDGE, they are so by high exponents
//! alone, and come again.

use super::plan_steps::{FLAT, exponents, reopening_sweep};
use super::state::{Corrections, Stage};
use crate::error::GpuError;
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::shape_guard::worst_movable;

/// The log2 of the exponent up to which flat triangles are not by the choice of EDGE.
const LAST: u32 = 3;
/// If the exponent has not doubled after this number of sweeps, flat triangles are reopened then. Most runs take three to eight.
const LATEST: u32 = 12;
/// The least number of sweeps, and the most if triangles are still flat. With half as many, runs take some ten sweeps more.
const SWEEPS: u32 = 8;
const MOST_SWEEPS: u32 = 32;
/// Sweeps end in vain if one lowers the largest inverse mean ratio by less than this share.
const OPENS: f64 = 0.02;

impl Corrections {
    /// Reopens flat triangles if there are any after the exponent `has_doubled` or was to do so, and goes back to the first exponent.
    /// Once because it was due, once because it has doubled. If sweeps do not open all of them, as the mesh may leave no room, the
    /// state before is restored, and the run goes on from there.
    pub(super) async fn reopen(
        &mut self,
        engine: &mut impl Engine,
        history: &mut History,
        has_doubled: bool,
    ) -> Result<(), GpuError> {
        let Some((metric, omega)) = reopening_sweep(&self.plan) else { return Ok(()) };
        let first = *exponents(&self.plan).start();
        let is_late = history.sweeps() == LATEST && self.sharpness == first;
        let is_due = self.sharpness <= LAST && (has_doubled || is_late);
        let is_left = history.sweeps().saturating_add(MOST_SWEEPS) < history.rule().max_sweeps;
        if self.was_reopened || !is_due || !is_left || history.stop().is_some() {
            return Ok(());
        }
        let mut worst = worst_movable(&self.problem, &engine.positions().await?);
        if worst <= FLAT {
            return Ok(());
        }
        self.was_reopened = has_doubled;
        let before = engine.save(true).await?;
        let step = self.plan.step_with(metric, omega, self.sharpness);
        let mut log = Vec::new();
        loop {
            engine.sweep(&step).await?;
            log.push(engine.objectives().await?);
            if log.len() < SWEEPS as usize {
                continue;
            }
            let last = worst;
            worst = worst_movable(&self.problem, &engine.positions().await?);
            if worst <= FLAT {
                break;
            }
            if worst > last * (1.0 - OPENS) || log.len() == MOST_SWEEPS as usize {
                engine.restore(&before)?;
                return Ok(());
            }
        }
        for objectives in log {
            history.add(objectives);
        }
        // The levels are of the stiffness of other triangles.
        self.drop_levels(engine);
        (self.settled, self.sharpness) = (false, first);
        self.stage = Stage::Before { until: history.f().len() };
        Ok(())
    }
}
