//! Reopens triangles that are flat at the minimum of EDGE's p-norm with a low exponent.
//!
//! EDGE has no barrier, and a flat triangle with three long edges has a small EDGE. At a local minimum a few percent
//! above the best, an untangled mesh, or a mesh with misplaced vertices, may have such triangles. Sweeps do not leave
//! this minimum: as the exponent grows, the triangles are flattened up to the shape guard. Triangles that should be
//! flat by EDGE become flat with high exponents alone, and so become flat again after reopening.

use super::plan_steps::{FLAT, exponents, reopening_sweep};
use super::state::{Corrections, Stage};
use crate::error::GpuError;
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::shape_guard::worst_movable;

/// Binary logarithm of the largest exponent at which flat triangles are reopened. With exponents up to this one, flat
/// triangles are not optimal by EDGE itself.
const LAST: u32 = 3;
/// Number of sweeps after which flat triangles are reopened although the exponent has not doubled. Most runs need three
/// to eight sweeps for the first doubling.
const LATEST: u32 = 12;
/// Smallest number of sweeps, and the largest if triangles stay flat. With half as many, runs take some ten sweeps
/// more.
const SWEEPS: u32 = 8;
const MAX_SWEEPS: u32 = 32;
/// Relative decrease of the largest inverse mean ratio by a sweep, below which reopening ends without success.
const OPENS: f64 = 0.02;

impl Corrections {
    /// Reopens flat triangles if a movable triangle is flatter than [`FLAT`], and returns to the first exponent. Acts
    /// at most twice: at sweep [`LATEST`] if the exponent has not doubled, and after a doubling (`has_doubled`). If
    /// sweeps leave a triangle flat, as the mesh may have no room, the former state is restored, and the run continues
    /// from there.
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
        let is_left = history.sweeps().saturating_add(MAX_SWEEPS) < history.rule().max_sweeps;
        if self.was_reopened || !is_due || !is_left || history.stop().is_some() {
            return Ok(());
        }
        let problem = engine.problem().clone();
        let mut worst = worst_movable(&problem, &engine.positions().await?).await;
        if worst <= FLAT {
            return Ok(());
        }
        self.was_reopened = has_doubled;
        let before = engine.save(true).await?;
        let step = self.plan.step_with(metric, omega, self.sharpness);
        let mut log = Vec::new();
        loop {
            log.push(engine.sweep(&step).await?);
            if log.len() < SWEEPS as usize {
                continue;
            }
            let last = worst;
            worst = worst_movable(&problem, &engine.positions().await?).await;
            if worst <= FLAT {
                break;
            }
            if worst > last * (1.0 - OPENS) || log.len() == MAX_SWEEPS as usize {
                engine.restore(&before).await?;
                return Ok(());
            }
        }
        for objectives in log {
            history.add(objectives);
        }
        // The levels fit the stiffness of the triangles before, which have changed shape.
        self.drop_levels(engine);
        (self.settled, self.sharpness) = (false, first);
        self.stage = Stage::Before { until: history.f().len() };
        Ok(())
    }
}
