//! The interface between the control of a run and the engine that computes it.

use glam::DVec2;
use std::borrow::Cow;
use std::future::Future;

use crate::error::GpuError;
use crate::layout::Problem;
use crate::metric::Smoothing;
use crate::run::history::History;
use crate::run::multilevel::Hierarchy;
use crate::run::objectives::Objectives;
use crate::run::saved::EngineState;
use crate::run::step::Step;

/// Computes a run, on the CPU or a device: sweeps, objectives, and corrections from coarser levels. Positions are
/// normalized and in the order of the [`Problem`].
///
/// An engine does not decide which sweep comes next. Calls return an error if the device fails; the run is then lost.
pub(crate) trait Engine: Send {
    /// Does one sweep.
    fn sweep(&mut self, step: &Step) -> impl Future<Output = Result<(), GpuError>> + Send;

    /// Evaluates the tracked objectives at the current positions.
    fn objectives(&mut self) -> impl Future<Output = Result<Objectives, GpuError>> + Send;

    /// Does sweeps until all `steps` are done or the stop rule of the history ends the run. Records the objectives
    /// after each sweep, and before the first if the history is empty. Stores the best state.
    ///
    /// A device may do all sweeps in one submission, and apply the stop rule itself.
    fn sweeps(
        &mut self,
        steps: &[Step],
        history: &mut History,
    ) -> impl Future<Output = Result<(), GpuError>> + Send;

    /// Moves the vertices to `positions`, those of all vertices, between two sweeps. Forgets what later corrections would
    /// be accelerated from.
    fn set_positions(&mut self, positions: &[DVec2]) -> Result<(), GpuError>;

    /// Holds free vertices: from then on sweeps and corrections move exactly those for which `held` is false.
    fn hold(&mut self, held: &[bool]) -> Result<(), GpuError>;

    /// Takes the targets of a problem that has the same layout, and other targets than before.
    fn set_targets(&mut self, problem: &Problem) -> Result<(), GpuError>;

    /// Returns the current positions of all vertices.
    fn positions(&mut self) -> impl Future<Output = Result<Cow<'_, [DVec2]>, GpuError>> + Send;

    /// Returns the positions of all vertices in the best of the states whose objectives were evaluated. That is the
    /// last state if every sweep by the plan lowers f.
    fn best_positions(&mut self) -> impl Future<Output = Result<Vec<DVec2>, GpuError>> + Send;

    /// Returns the coarser levels, if the engine has any, and leaves it without.
    fn take_hierarchy(&mut self) -> Option<Hierarchy>;

    /// Hands the coarser levels to the engine. Fails with [`GpuError::Limit`] if there is no room for them.
    fn set_hierarchy(&mut self, hierarchy: Hierarchy) -> Result<(), GpuError>;

    /// Returns, for each free vertex, the root r = √((|λ₁| + |λ₂|) / 2 / degree), with λ the eigenvalues of the Hessian of
    /// Σ q² over the patch by the base metric. `smoothing` makes EDGE smooth. The levels are built from edge weights
    /// r(v) r(w).
    fn stiffness_roots(
        &mut self,
        smoothing: Smoothing,
    ) -> impl Future<Output = Result<Vec<f32>, GpuError>> + Send;

    /// Does one sweep, then computes the correction from the coarser levels and tries it at `length`. If `accelerated`,
    /// the correction also uses secant pairs, the changes of the gradient since earlier accelerated corrections; see
    /// [`secant`](crate::run::secant). If not, the pairs are dropped.
    fn propose(
        &mut self,
        step: &Step,
        length: f64,
        accelerated: bool,
    ) -> impl Future<Output = Result<Proposal, GpuError>> + Send;

    /// Forgets what is remembered of the last corrections, for the next to be accelerated from anew.
    fn forget(&mut self);

    /// Leaves vertices out of the last correction, and tries what remains of it at `length`: those of triangles that the correction
    /// would invert or bring to break the shape guard at this length, [`LEFT_OUT`] times, as triangles between them and others
    /// may give way only then. If `anew`, the correction is first computed again without their gradients.
    fn leave_out(
        &mut self,
        length: f64,
        anew: bool,
    ) -> impl Future<Output = Result<Proposal, GpuError>> + Send;

    /// Returns the mean excess, as in a [`Proposal`], after a move of all free vertices by `length` times the
    /// correction. `None` if that inverts a triangle or breaks the shape guard.
    fn excess_along(
        &mut self,
        length: f64,
    ) -> impl Future<Output = Result<Option<f64>, GpuError>> + Send;

    /// Moves all free vertices by `length` times the correction.
    fn move_along(&mut self, length: f64) -> impl Future<Output = Result<(), GpuError>> + Send;

    /// Returns the present state, between two sweeps. If `whole`, it has all data needed to continue to the same bits,
    /// else only the positions.
    fn save(&mut self, whole: bool) -> impl Future<Output = Result<EngineState, GpuError>> + Send;

    /// Restores a saved state, before the first sweep or between two. Returns whether the state is from this mesh and from an engine
    /// that this one can continue. A state that is not whole leaves the engine without coarser levels.
    fn restore(&mut self, state: &EngineState) -> Result<bool, GpuError>;
}

/// Number of times that vertices are left out of a correction. On meshes of 2,000 vertices, some triangles were still
/// broken after one time, and none after two.
pub(crate) const LEFT_OUT: usize = 2;

/// A correction that has been computed but not taken. Objectives are mean excesses: f - ideal² of the base metric, of which EDGE is
/// replaced by what the step's smoothing makes of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Proposal {
    /// The objective without the correction.
    pub(crate) here: f64,
    /// The derivative of the objective along the correction.
    pub(crate) slope: f64,
    /// The objective at the length that was tried. `None` if that inverts a triangle or breaks the shape guard. Only
    /// meaningful if `slope` is negative.
    pub(crate) there: Option<f64>,
}
