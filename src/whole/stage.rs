//! The interface of stages: work on the host between sweeps, and the decision whether the run ends.

use crate::error::MeshError;
use crate::run::Stop;
use crate::run::records::{Reader, Writer};
use crate::whole::host::Host;

/// A stage of a run: work on the host between sweeps on the engine.
pub(crate) trait Stage: Send + Sync {
    /// Returns the name of the stage in checkpoints.
    fn name(&self) -> &'static str;

    /// Returns the largest number of sweeps before the stage works again.
    fn period(&self) -> u32;

    /// Works on the state after some sweeps. A stage that moves free vertices otherwise than the sweeps did first asks
    /// [`Host::is_sound`], which applies the bounds of the problem.
    ///
    /// # Errors
    /// [`MeshError::NotFinite`] if the stage must evaluate a target at an infinite or NaN position.
    fn work(&mut self, host: &mut Host<'_>) -> Result<(), MeshError>;

    /// Decides whether the run ends. The driver asks only the last stage of a run.
    fn judge(&mut self, period: &Period) -> Judgment;

    /// Writes the state of the stage between two periods to a checkpoint.
    fn save(&self, out: &mut Writer);

    /// Restores a state that [`save`](Self::save) wrote. The vertices of `host` have the positions of the saved period.
    /// `None` if the state belongs to a run on another mesh.
    fn restore(&mut self, host: &mut Host<'_>, from: &mut Reader<'_>) -> Option<()>;
}

/// A finished period: sweeps, and the work of all stages after the sweeps.
pub(crate) struct Period {
    /// f by the base metric before and after the period.
    pub(crate) f: [f64; 2],
    /// Whether the run has reached its largest number of sweeps.
    pub(crate) is_last: bool,
}

/// A decision after a period.
pub(crate) struct Judgment {
    /// Reason why the run ends. `None` if the run continues.
    pub(crate) stop: Option<Stop>,
    /// Estimated remaining gain as a share of f. `None` without an estimate.
    pub(crate) remaining: Option<f64>,
}
