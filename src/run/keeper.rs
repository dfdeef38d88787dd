//! What is kept of a run while it goes on, so that little is lost whatever happens.

use std::time::Duration;

use web_time::Instant;

use crate::error::GpuError;
use crate::run::checkpoint::{About, Checkpoint};
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::saved::Saved;

/// Decides what is kept of a run, and what follows when a device fails. Every method has a default: nothing is kept, and
/// a run ends with the error of its device.
pub trait Keeper {
    /// Whether a checkpoint is to be taken now. Asked between two sweeps, about ten times a second, and once more where the
    /// [`Observer`](crate::Observer) ends the run: then `is_ending` is set.
    fn wants_checkpoint(&mut self, is_ending: bool) -> bool {
        let _ = is_ending;
        false
    }

    /// Receives a checkpoint that was asked for.
    fn checkpoint(&mut self, checkpoint: Checkpoint) {
        let _ = checkpoint;
    }

    /// The device has failed. Returns whether the run is to go on on the CPU, from the state after sweep `from`.
    fn goes_on_without(&mut self, error: &GpuError, from: u32) -> bool {
        let _ = (error, from);
        false
    }

    /// How often the positions are kept in memory, for the run to go back to if something fails. More rarely where that would take
    /// more than a fiftieth of the time.
    fn interval(&self) -> Duration {
        Duration::from_secs(1)
    }
}

/// Keeps nothing.
pub(crate) struct NoKeeper;

impl Keeper for NoKeeper {}

/// The share of the time that keeping the positions may take, as a divisor.
const SHARE: u32 = 50;

/// What is kept of a run.
pub(crate) struct Keeping<'k, K: ?Sized> {
    pub(crate) keeper: &'k mut K,
    /// What a checkpoint says besides the state; `None` in a run that has none.
    pub(crate) about: Option<About>,
    /// The latest state that was kept.
    pub(crate) last: Option<Saved>,
    /// When the next one is due; `None` if never.
    due: Option<Instant>,
}

impl<'k, K: Keeper + ?Sized> Keeping<'k, K> {
    pub(crate) fn new(keeper: &'k mut K) -> Self {
        let due = Instant::now().checked_add(keeper.interval());
        Self { keeper, about: None, last: None, due }
    }

    /// Keeps what is due after some sweeps, or at the end of a run that is cancelled.
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
            // Without memory for it, the run goes on. Whatever else is wrong, the next sweep tells.
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
