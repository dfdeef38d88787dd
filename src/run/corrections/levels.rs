//! When the coarser levels are built, and fitted to a mesh that has changed.

use super::plan_steps::OMEGA_BETWEEN;
use super::state::Corrections;
use crate::error::GpuError;
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::multilevel::Hierarchy;
use crate::run::yielding::yield_now;

/// Number of corrections tried after which the levels are fitted again, if the stiffness of the mesh has changed.
/// Accelerated corrections fit them whenever it has changed: vertices then move far, and levels that stay as they were
/// built gain little (a layer that opens up took three times the sweeps).
const REFIT_AFTER: u32 = 2;
/// The stiffness counts as changed if the excess of f has dropped by more than this share since the levels were built
/// or fitted.
const REFIT_IF: f64 = 0.15;
/// Once corrections are accelerated, the levels are built anew when the excess of f has dropped by more than this share since they
/// were built: the factors by which they are fitted are only close to the Galerkin operators. So there are at most four fits
/// between, and as many for the exponents of EDGE, whose roots are kept for checkpoints.
const REBUILD_IF: f64 = 0.5;
/// By EDGE, levels are fitted each time that the exponent has doubled as often. Never, the last exponents took ten times the sweeps; each
/// time, a few less.
const REFIT_EVERY: u32 = 3;

/// How levels come to stand for the present stiffness of the mesh.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Change {
    Build,
    Fit,
}

impl Corrections {
    /// Decides how the levels change before the next correction. `proposed` is the number of corrections tried in this
    /// stage, `now` the index of the last evaluation.
    pub(super) fn change_of_levels(
        &self,
        history: &History,
        now: usize,
        proposed: u32,
    ) -> Option<Change> {
        let excess = self.excess(history, now);
        let dropped = |since: usize, share: f64| {
            let before = self.excess(history, since);
            before - excess > share * before
        };
        match proposed {
            _ if !self.has_levels => Some(Change::Build),
            0 if self.has_levels && !self.metric().is_smooth() => {
                self.sharpness.is_multiple_of(REFIT_EVERY).then_some(Change::Fit)
            }
            0 => Some(Change::Build),
            _ if self.accelerated && dropped(self.built, REBUILD_IF) => Some(Change::Build),
            _ if !self.accelerated && proposed != REFIT_AFTER => None,
            _ => dropped(self.fitted, REFIT_IF).then_some(Change::Fit),
        }
    }

    /// Drops the levels, so that they are built anew before the next correction. Returns the number of corrections proposed with the new
    /// ones.
    pub(super) fn drop_levels(&mut self, engine: &mut impl Engine) -> u32 {
        engine.take_hierarchy();
        self.has_levels = false;
        0
    }

    /// Builds the levels, or fits them to the present stiffness, and hands them to the engine. Returns whether the
    /// engine has room for them. `now` is the index of the last evaluation.
    pub(super) async fn change_levels(
        &mut self,
        engine: &mut impl Engine,
        change: Change,
        now: usize,
    ) -> Result<bool, GpuError> {
        yield_now().await;
        // Levels that are not needed again are freed before new ones are built.
        let before = engine.take_hierarchy().filter(|_| change == Change::Fit);
        self.fitted = now;
        if before.is_none() {
            self.built = now;
        }
        let roots = engine.stiffness_roots(self.step(OMEGA_BETWEEN).smoothing()).await?;
        let hierarchy = match before {
            Some(before) => before.fitted_to(&self.problem, roots),
            None => Hierarchy::new(&self.problem, roots),
        };
        yield_now().await;
        match engine.set_hierarchy(hierarchy) {
            Err(error @ GpuError::Limit { .. }) => {
                self.left_out = Some(error);
                Ok(false)
            }
            set => {
                self.has_levels = true;
                set.map(|()| true)
            }
        }
    }
}
