//! Saves the state of a run at intervals, so that a failure loses little work.

use std::time::Duration;

use web_time::Instant;

use crate::error::GpuError;
use crate::run::checkpoint::{Checkpoint, RunFingerprint};
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::named::Named;
use crate::run::saved::{PeriodState, Saved};

/// Decides when a run takes checkpoints, and whether the run falls back to the CPU if its device fails. Every method
/// has a default: a run takes no checkpoint, and a failed device ends the run with an error.
///
/// `&mut P` is a policy if `P` is.
pub trait CheckpointPolicy: Send {
    /// Returns whether the run takes a checkpoint now. The run asks between two sweeps, about ten times a second. If
    /// the [`Observer`](crate::Observer) ends the run, the run asks again, with `is_ending` set. A run that wants no checkpoint
    /// then ends at once, also in the middle of a step of all vertices.
    fn wants_checkpoint(&mut self, is_ending: bool) -> bool {
        let _ = is_ending;
        false
    }

    /// Receives a checkpoint that [`wants_checkpoint`](Self::wants_checkpoint) asked for.
    fn checkpoint(&mut self, checkpoint: Checkpoint) {
        let _ = checkpoint;
    }

    /// Returns whether the run continues on the CPU after the device has failed with `error`. The CPU would start from
    /// the state after sweep `from`.
    fn falls_back_to_cpu(&mut self, error: &GpuError, from: u32) -> bool {
        let _ = (error, from);
        false
    }

    /// Returns the interval at which the run saves its positions in memory, to return to them if a device fails. If
    /// saving would take more than 2 % of the time, the run saves at longer intervals.
    fn interval(&self) -> Duration {
        Duration::from_secs(1)
    }
}

impl<P: CheckpointPolicy + ?Sized> CheckpointPolicy for &mut P {
    fn wants_checkpoint(&mut self, is_ending: bool) -> bool {
        (**self).wants_checkpoint(is_ending)
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) {
        (**self).checkpoint(checkpoint);
    }

    fn falls_back_to_cpu(&mut self, error: &GpuError, from: u32) -> bool {
        (**self).falls_back_to_cpu(error, from)
    }

    fn interval(&self) -> Duration {
        (**self).interval()
    }
}

/// A policy without checkpoints: all methods have their defaults.
pub(crate) struct NoCheckpoints;

impl CheckpointPolicy for NoCheckpoints {}

/// Smallest ratio of the time between two saves to the time of a save.
const SHARE: u32 = 50;

/// The checkpoint policy of a run, together with the latest saved state.
pub(crate) struct Checkpointer<'k> {
    pub(crate) policy: &'k mut dyn CheckpointPolicy,
    /// Data of checkpoints besides the state. `None` for a run without checkpoints.
    pub(crate) about: Option<RunFingerprint>,
    /// Latest saved state, to which the run returns after a failure.
    pub(crate) last: Option<Saved>,
    /// Time of the next save. `None` for no further saves.
    due: Option<Instant>,
}

impl<'k> Checkpointer<'k> {
    pub(crate) fn new(policy: &'k mut dyn CheckpointPolicy, about: Option<RunFingerprint>) -> Self {
        let due = Instant::now().checked_add(policy.interval());
        Self { policy, about, last: None, due }
    }

    /// Saves the state after some sweeps if a save is due, or if the policy wants a checkpoint.
    pub(crate) async fn after_sweeps(
        &mut self,
        engine: &mut impl Engine,
        history: &History,
        control: impl FnOnce() -> Named,
        period: impl FnOnce() -> Option<PeriodState>,
        is_ending: bool,
    ) -> Result<(), GpuError> {
        let whole = self.about.is_some() && self.policy.wants_checkpoint(is_ending);
        let start = Instant::now();
        if !whole && (is_ending || self.due.is_none_or(|due| start < due)) {
            return Ok(());
        }
        let engine = match engine.save(whole).await {
            Ok(engine) => engine,
            // Without memory for the state, the run continues. The next sweep reports any other error.
            Err(GpuError::OutOfMemory(_)) => return Ok(()),
            Err(error) => return Err(error),
        };
        let (log, remaining) = (history.log().to_vec(), history.remaining());
        let saved = Saved { log, remaining, control: control(), engine };
        if let (true, Some(about)) = (whole, &self.about) {
            let (about, saved) = (about.clone(), saved.clone());
            self.policy.checkpoint(Checkpoint { about, saved, period: period() });
        }
        self.last = Some(saved);
        let next = self.policy.interval().max(SHARE * start.elapsed());
        self.due = Instant::now().checked_add(next);
        Ok(())
    }
}
