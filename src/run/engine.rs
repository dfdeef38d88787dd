//! What a run asks of the place where it computes.

use glam::DVec2;
use std::borrow::Cow;
use std::future::Future;

use crate::error::GpuError;
use crate::run::history::History;
use crate::run::multilevel::Hierarchy;
use crate::run::objectives::Objectives;
use crate::run::step::Step;

/// A mesh whose free vertices are swept, judged, and moved along corrections, somewhere. Positions are normalized
/// and in the order of the [`Problem`](crate::layout::Problem).
///
/// Which sweep comes next, and when to stop, is not decided here.
pub(crate) trait Engine: Send {
    /// One sweep.
    ///
    /// # Errors
    /// When the device fails; the run is then lost. So it is with all calls.
    fn sweep(&mut self, step: &Step) -> impl Future<Output = Result<(), GpuError>> + Send;

    /// The objectives of the tracked metrics now.
    fn objectives(&mut self) -> impl Future<Output = Result<Objectives, GpuError>> + Send;

    /// Some sweeps, the objectives recorded before the first if there are none yet, and after each; the best state is
    /// remembered. Ends when the history says that the run is over.
    ///
    /// A device may do all in one submission, and judge by the rule itself.
    fn sweeps(
        &mut self,
        steps: &[Step],
        history: &mut History,
    ) -> impl Future<Output = Result<(), GpuError>> + Send;

    /// All positions now.
    fn positions(&mut self) -> impl Future<Output = Result<Cow<'_, [DVec2]>, GpuError>> + Send;

    /// All positions of the best state that [`sweeps`](Self::sweeps) came through.
    fn best_positions(&mut self) -> impl Future<Output = Result<Vec<DVec2>, GpuError>> + Send;

    /// Gives back the coarser levels it was given, if any.
    fn take_hierarchy(&mut self) -> Option<Hierarchy>;

    /// Takes the coarser levels, or fails with [`GpuError::Limit`] if there is no room for them.
    fn set_hierarchy(&mut self, hierarchy: Hierarchy) -> Result<(), GpuError>;

    /// One sweep, then the correction from the coarser levels, tried at `length`.
    fn propose(
        &mut self,
        step: &Step,
        length: f64,
    ) -> impl Future<Output = Result<Proposal, GpuError>> + Send;

    /// The mean excess of the base metric with all free vertices moved `length` times along the correction;
    /// `None` if a triangle is inverted there, or breaks the shape guard.
    fn excess_along(
        &mut self,
        length: f64,
    ) -> impl Future<Output = Result<Option<f64>, GpuError>> + Send;

    /// Moves them there.
    fn move_along(&mut self, length: f64) -> impl Future<Output = Result<(), GpuError>> + Send;
}

/// A correction, before it is taken. Objectives are mean excesses: f less the metric's ideal value squared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Proposal {
    /// The objective without it.
    pub(crate) here: f64,
    /// Its derivative along the correction.
    pub(crate) slope: f64,
    /// The objective at the length asked for; `None` as in [`Engine::excess_along`].
    pub(crate) there: Option<f64>,
}
