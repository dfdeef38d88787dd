//! The interface between the control of a run and the engine, which computes on the CPU or a device.

use glam::DVec2;
use std::borrow::Cow;
use std::future::Future;

use crate::error::GpuError;
use crate::layout::Problem;
use crate::metric::Smoothing;
use crate::run::history::History;
use crate::run::multilevel::Hierarchy;
use crate::run::objectives::Objectives;
use crate::run::progress::GoesOn;
use crate::run::saved::EngineState;
use crate::run::sweep_params::SweepParams;
use crate::run::truncated::{NewtonStep, StepRequest};

/// Sweeps, objectives and corrections from coarser levels, on the CPU or a device. Positions are normalized and in the
/// order of the [`Problem`].
///
/// The caller decides which sweep comes next. Calls return an error if the device fails; the run is then lost.
pub(crate) trait Engine: Send {
    /// Returns the layout of the mesh, with the present targets and local maps.
    fn problem(&self) -> &Problem;

    /// Returns the relative error of an evaluated f. Gains below the error do not decay.
    fn noise(&self) -> f64;

    /// Visits every free vertex once, by `step`, and evaluates the tracked objectives afterward. A device does both in one
    /// submission: between two submissions, some drivers block the thread until the first is done.
    fn sweep(
        &mut self,
        step: &SweepParams,
    ) -> impl Future<Output = Result<Objectives, GpuError>> + Send;

    /// Evaluates the tracked objectives at the present positions.
    fn objectives(&mut self) -> impl Future<Output = Result<Objectives, GpuError>> + Send;

    /// Sweeps by `steps` in order, until all are done or the stop rule of the history ends the run. Records the
    /// objectives after each sweep. If the history is empty, records the objectives before the first sweep too. Stores
    /// the best state.
    ///
    /// A device may do all sweeps in one submission, and apply the stop rule by itself.
    fn sweeps(
        &mut self,
        steps: &[SweepParams],
        history: &mut History,
    ) -> impl Future<Output = Result<(), GpuError>> + Send;

    /// Moves all vertices to `positions`, between two sweeps. Drops the secant pairs of earlier corrections.
    fn set_positions(&mut self, positions: &[DVec2]) -> Result<(), GpuError>;

    /// Replaces the targets and local maps by those of `problem`. Its layout must equal that of the engine's problem.
    fn set_maps(&mut self, problem: &Problem) -> Result<(), GpuError>;

    /// Returns the present positions of all vertices.
    fn positions(&mut self) -> impl Future<Output = Result<Cow<'_, [DVec2]>, GpuError>> + Send;

    /// Returns the positions of all vertices in the best evaluated state. If every sweep of the plan lowers f, the best
    /// state is the last one.
    fn best_positions(&mut self) -> impl Future<Output = Result<Vec<DVec2>, GpuError>> + Send;

    /// Removes the coarser levels from the engine and returns them. `None` if the engine has no levels.
    fn take_hierarchy(&mut self) -> Option<Hierarchy>;

    /// Gives the coarser levels to the engine. Fails with [`GpuError::Limit`] if the device has no room for the levels.
    fn set_hierarchy(
        &mut self,
        hierarchy: Hierarchy,
    ) -> impl Future<Output = Result<(), GpuError>> + Send;

    /// Returns, for each free vertex, the root r = √((|λ₁| + |λ₂|) / 2 / degree), with λ the eigenvalues of the Hessian
    /// of Σ q² over the patch by the base metric. `smoothing` makes EDGE smooth. The levels are built from edge weights
    /// r(v) r(w).
    fn stiffness_roots(
        &mut self,
        smoothing: Smoothing,
    ) -> impl Future<Output = Result<Vec<f32>, GpuError>> + Send;

    /// Sweeps once, then computes the correction from the coarser levels and evaluates it at `length`. If
    /// `accelerated`, the correction also uses secant pairs, the changes of the gradient since earlier accelerated
    /// corrections; see [`secant`](crate::run::secant). If not, the engine drops its pairs.
    fn sweep_and_propose(
        &mut self,
        step: &SweepParams,
        length: f64,
        accelerated: bool,
    ) -> impl Future<Output = Result<Proposal, GpuError>> + Send;

    /// Sweeps once, and then takes a Newton step of all vertices from there: derivatives, conjugate gradients and a line
    /// search. The engine calls `goes_on` between two iterations. If `goes_on` returns false, no step follows the sweep. `None`, and nothing
    /// happens, if the engine takes no such steps.
    fn sweep_and_step(
        &mut self,
        _step: &SweepParams,
        _request: &StepRequest,
        _goes_on: &mut GoesOn<'_>,
    ) -> impl Future<Output = Result<Option<NewtonStep>, GpuError>> + Send {
        std::future::ready(Ok(None))
    }

    /// Returns how far a Newton step of all vertices could lower the mean excess from the present positions: the gain of the
    /// quadratic model, with the bound of its rest. Moves no vertex. `None` if the model has negative curvature, if the
    /// engine takes no such steps, or if the run does not go on.
    fn remaining(
        &mut self,
        _step: &SweepParams,
        _request: &StepRequest,
        _goes_on: &mut GoesOn<'_>,
    ) -> impl Future<Output = Result<Option<f64>, GpuError>> + Send {
        std::future::ready(Ok(None))
    }

    /// Resumes a run that the stop rule has ended in [`sweeps`](Self::sweeps), with another tolerance.
    fn go_on(&mut self, tolerance: f64) -> Result<(), GpuError>;

    /// Drops the secant pairs, so that the next accelerated correction starts without any.
    fn forget(&mut self);

    /// Excludes vertices from the last correction, and evaluates the rest of the correction at `length`. Excluded are
    /// the vertices of triangles that a move by `length` would invert or push over the shape guard. [`EXCLUSION_PASSES`] passes
    /// exclude vertices, as further triangles may break next to excluded ones. If `anew`, the engine first computes the
    /// correction again without the gradients of the excluded vertices.
    fn exclude_broken(
        &mut self,
        length: f64,
        anew: bool,
    ) -> impl Future<Output = Result<Proposal, GpuError>> + Send;

    /// Returns the mean excess, as in a [`Proposal`], after a move of all free vertices by `length` times the
    /// correction. `None` if the move inverts a triangle or breaks the shape guard.
    fn excess_along(
        &mut self,
        length: f64,
    ) -> impl Future<Output = Result<Option<f64>, GpuError>> + Send;

    /// Moves all free vertices by `length` times the correction.
    fn move_along(&mut self, length: f64) -> impl Future<Output = Result<(), GpuError>> + Send;

    /// Moves all free vertices by `length` times the correction, and evaluates the tracked objectives afterward.
    fn objectives_after_move(
        &mut self,
        length: f64,
    ) -> impl Future<Output = Result<Objectives, GpuError>> + Send;

    /// Returns the present state, between two sweeps. If `whole`, a run that continues from the state computes the same
    /// bits. Otherwise the state has only the positions.
    fn save(&mut self, whole: bool) -> impl Future<Output = Result<EngineState, GpuError>> + Send;

    /// Restores a saved state, before the first sweep or between two sweeps. Returns false if the state is from another
    /// mesh, or from an engine that this engine cannot continue. If the state is not whole, the engine has no coarser
    /// levels afterward.
    fn restore(
        &mut self,
        state: &EngineState,
    ) -> impl Future<Output = Result<bool, GpuError>> + Send;
}

/// Number of passes that exclude vertices from a correction. On meshes of 2,000 vertices, some triangles were still
/// broken after one pass, and none after two.
pub(crate) const EXCLUSION_PASSES: usize = 2;

/// A proposed correction: the objective along it, before any vertex moves. Objectives are mean excesses, f - ideal² of
/// the base metric. EDGE is replaced by the p-norm with the step's smoothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Proposal {
    /// Mean excess at the present positions.
    pub(crate) here: f64,
    /// Derivative of the mean excess along the correction.
    pub(crate) slope: f64,
    /// Mean excess after a move by the tried length. `None` if the move inverts a triangle or breaks the shape guard.
    /// Meaningful only if `slope` is negative.
    pub(crate) there: Option<f64>,
}
