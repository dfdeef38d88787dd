//! Decides when the coarser levels are built, and when they are fitted to a mesh that has changed.

use web_time::Instant;

use super::plan_steps::OMEGA_BETWEEN;
use super::state::{Corrections, ESTIMATES};
use crate::error::GpuError;
use crate::layout::Problem;
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::multilevel::Hierarchy;

/// Number of corrections after which levels are fitted to a changed stiffness. Accelerated corrections fit the levels
/// after every such change: vertices then move far, and unchanged levels gain little. A layer that opens up took three
/// times the sweeps with unchanged levels.
const REFIT_AFTER: u32 = 2;
/// Relative decrease of the excess of f since the levels were built or fitted, above which the stiffness counts as
/// changed.
const REFIT_IF: f64 = 0.15;
/// Relative decrease of the excess of f since the levels were built, above which accelerated corrections build them
/// again. Fits by factors only approximate the Galerkin operators. At most four fits follow a build, and the exponents
/// of EDGE cause at most four. So checkpoints store few lists of roots.
const REBUILD_IF: f64 = 0.5;
/// Number of doublings of EDGE's exponent between two fits of the levels. Without fits, the last exponents took ten
/// times the sweeps. With a fit after each doubling, they took slightly fewer sweeps.
const REFIT_EVERY: u32 = 3;

/// Number of corrections of a stage at which its levels are first replaced by new levels. Each doubling of the number replaces
/// the levels too. Where f stays far above its lower limit, its excess does not tell how far vertices have moved. A mesh
/// adapted to layers of 60 took 263 sweeps with the levels of its first correction, and takes 173.
const REBUILD_FROM: u32 = 32;
/// Replaces [`REBUILD_FROM`] on a strongly stretched mesh, whose local maps change too.
const REBUILD_LOCAL_FROM: u32 = 4;

/// How the levels adapt to the present stiffness of the mesh.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Change {
    Build,
    Fit,
}

impl Corrections {
    /// Decides how the levels change before the next correction, `None` for no change. `proposed` is the number of
    /// corrections computed in this stage, `now` the index of the last evaluation in the history.
    pub(super) fn change_of_levels(
        &self,
        problem: &Problem,
        history: &History,
        now: usize,
        proposed: u32,
    ) -> Option<Change> {
        let excess = self.excess(history, now);
        let dropped = |since: usize, share: f64| {
            let before = self.excess(history, since);
            before - excess > share * before
        };
        let rebuild_from = match problem.has_local_maps() {
            true => REBUILD_LOCAL_FROM,
            // The exponents of EDGE decide when its levels change. Stages change the targets between sweeps.
            false if self.has_field || !self.metric().is_smooth() => u32::MAX,
            false => REBUILD_FROM,
        };
        match proposed {
            _ if !self.has_levels => Some(Change::Build),
            _ if proposed >= rebuild_from && proposed.is_power_of_two() => Some(Change::Build),
            0 if self.has_levels && !self.metric().is_smooth() => {
                self.sharpness.is_multiple_of(REFIT_EVERY).then_some(Change::Fit)
            }
            0 => Some(Change::Build),
            _ if self.accelerated && dropped(self.built, REBUILD_IF) => Some(Change::Build),
            _ if !self.accelerated && proposed != REFIT_AFTER => None,
            _ => dropped(self.fitted, REFIT_IF).then_some(Change::Fit),
        }
    }

    /// Drops levels in the coordinates of the maps after refused corrections, or after many corrections. Later levels
    /// work in the coordinates of the plane. Around a vertex of 50 with the targets of `keep_shape`, corrections
    /// by the former levels had lengths below 0.001, and five runs took 59 to 204 sweeps. By the latter levels, the five
    /// runs take 22 to 40.
    pub(super) fn leave_maps(&mut self, engine: &mut impl Engine) -> Result<(), GpuError> {
        let mut problem = engine.problem().clone();
        if !problem.is_stretched() || problem.are_levels_in_plane() {
            return Ok(());
        }
        self.drop_levels(engine);
        // Secant pairs and gains belong to the former levels.
        engine.forget();
        self.estimates = [f64::INFINITY; ESTIMATES];
        problem.set_levels_in_plane();
        engine.set_maps(&problem)
    }

    /// Drops the levels, which are then built again before the next correction. Returns 0, the number of corrections
    /// computed with the new levels.
    pub(super) fn drop_levels(&mut self, engine: &mut impl Engine) -> u32 {
        engine.take_hierarchy();
        self.has_levels = false;
        0
    }

    /// Builds the levels, or fits them to the present stiffness, and passes them to the engine. Returns false if the
    /// engine has no room for the levels. `now` is the history index of the last evaluation.
    pub(super) async fn change_levels(
        &mut self,
        engine: &mut impl Engine,
        change: Change,
        now: usize,
    ) -> Result<bool, GpuError> {
        let began = Instant::now();
        // Levels that are replaced are freed before new levels are built.
        let before = engine.take_hierarchy().filter(|_| change == Change::Fit);
        self.fitted = now;
        if before.is_none() {
            self.built = now;
        }
        let mut problem = engine.problem().clone();
        if problem.has_local_maps() {
            // The levels fit the stiffness in local coordinates, which follow the triangles.
            problem.set_local_maps_at(&engine.positions().await?).await;
            engine.set_maps(&problem)?;
            // Gains by other levels predict nothing.
            self.estimates = [f64::INFINITY; ESTIMATES];
        }
        let roots = engine.stiffness_roots(self.step(OMEGA_BETWEEN).smoothing()).await?;
        let hierarchy = match before {
            Some(before) => before.fitted_to(&problem, roots).await,
            None => Hierarchy::new(&problem, roots).await,
        };
        let set = engine.set_hierarchy(hierarchy).await;
        self.levels_time += began.elapsed();
        match set {
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
