//! Saves the state of a run from time to time, so that little is lost if something fails.

use std::time::Duration;

use web_time::Instant;

use crate::error::GpuError;
use crate::run::checkpoint::{About, Checkpoint};
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::saved::Saved;

/// Decides which states of a run are saved, and whether the run continues when a device fails. Every method has a
/// default: no checkpoint is taken, and a run ends with the error of its device.
pub trait Keeper {
    /// Whether a checkpoint is to be taken now. Called between two sweeps, about ten times a second, and once more,
    /// with `is_ending` set, when the [`Observer`](crate::Observer) ends the run.
    fn wants_checkpoint(&mut self, is_ending: bool) -> bool {
        let _ = is_ending;
        false
    }

    /// Receives a checkpoint that was requested.
    fn checkpoint(&mut self, checkpoint: Checkpoint) {
        let _ = checkpoint;
    }

    /// Called when the device has failed. Returns whether the run is to continue on the CPU, from the state after sweep
    /// `from`.
    fn goes_on_without(&mut self, error: &GpuError, from: u32) -> bool {
        let _ = (error, from);
        false
    }

    /// Returns the interval at which positions are saved in memory, for the run to return to if something fails. The
    /// actual interval is longer if saving would take more than a fiftieth of the time.
    fn interval(&self) -> Duration {
        Duration::from_secs(1)
    }
}

/// A keeper that takes no checkpoints.
pub(crate) struct NoKeeper;

impl Keeper for NoKeeper {}

/// The divisor of the share of the time that saving positions may take: one in this many.
const SHARE: u32 = 50;

/// The keeper of a run, with the states that were saved.
pub(crate) struct Keeping<'k, K: ?Sized> {
    pub(crate) keeper: &'k mut K,
    /// The data of checkpoints other than the state; `None` for a run without checkpoints.
    pub(crate) about: Option<About>,
    /// The latest state that was saved.
    pub(crate) last: Option<Saved>,
    /// When the next state is to be saved; `None` for never.
    due: Option<Instant>,
}

impl<'k, K: Keeper + ?Sized> Keeping<'k, K> {
    pub(crate) fn new(keeper: &'k mut K) -> Self {
        let due = Instant::now().checked_add(keeper.interval());
        Self { keeper, about: None, last: None, due }
    }

    /// Saves the state if that is due after some sweeps, or at the end of a run that is canceled.
    pub(crate) async fn after_sweeps(
        &mut self,
        engine: &mut impl Engine,
        history: &History,
        corrections: impl FnOnce() -> Option<Vec<u64>>,
        is_ending: bool,
    ) -> Result<(), GpuError> {
        let whole = self.about.is_some() && self.keeper.wants_checkpoint(is_ending);
        let start = Instant::now();
        if !whole && (is_ending || self.due.is_none_or(|due| start < due)) {
            return Ok(());
        }
        let engine = match engine.save(whole).await {
            Ok(engine) => engine,
            // Without memory for the state, the run continues. Any other error shows in the next sweep.
            Err(GpuError::OutOfMemory(_)) => return Ok(()),
            Err(error) => return Err(error),
        };
        let (log, remaining) = (history.log().to_vec(), history.remaining());
        let saved = Saved { log, remaining, corrections: corrections(), engine };
        if let (true, Some(about)) = (whole, &self.about) {
            self.keeper.checkpoint(Checkpoint { about: about.clone(), saved: saved.clone() });
        }
        self.last = Some(saved);
        let next = self.keeper.interval().max(SHARE * start.elapsed());
        self.due = Instant::now().checked_add(next);
        Ok(())
    }
}
