//! Saves the state of a run from time to time, so that little is lost if something fails.

use std::time::Duration;

use web_time::Instant;

use crate::error::GpuError;
use crate::run::checkpoint::{About, Checkpoint};
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::saved::{PeriodState, Saved};

/// Decides when a run takes checkpoints, and whether the run falls back to the CPU if its device fails. Every method has
/// a default: a run takes no checkpoint, and a failed device ends the run with an error.
///
/// `&mut P` is a policy if `P` is.
pub trait CheckpointPolicy: Send {
    /// Returns whether the run takes a checkpoint now. The run asks between two sweeps, about ten times a second. If the
    /// [`Observer`](crate::Observer) ends the run, the run asks once more, with `is_ending` set.
    fn wants_checkpoint(&mut self, is_ending: bool) -> bool {
        let _ = is_ending;
        false
    }

    /// Receives a checkpoint that [`wants_checkpoint`](Self::wants_checkpoint) asked for.
    fn checkpoint(&mut self, checkpoint: Checkpoint) {
        let _ = checkpoint;
    }

    /// Returns whether the run continues on the CPU, from its state after sweep `from`, now that the device has failed
    /// with `error`.
    fn falls_back_to_cpu(&mut self, error: &GpuError, from: u32) -> bool {
        let _ = (error, from);
        false
    }

    /// Returns the interval at which the run saves its positions in memory, to return to them if a device fails. The
    /// actual interval is longer if saving would take more than a fiftieth of the time.
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

/// A policy that takes no checkpoints.
pub(crate) struct NoCheckpoints;

impl CheckpointPolicy for NoCheckpoints {}

/// Returns the state of the host and of the stages when the present period began; `None` in a run without stages.
pub(crate) type PeriodSource<'p> = Option<&'p (dyn Fn() -> PeriodState + Sync)>;

/// The divisor of the share of the time that saving positions may take: one in this many.
const SHARE: u32 = 50;

/// The checkpoint policy of a run, with the latest state that was saved.
pub(crate) struct Checkpointer<'k> {
    pub(crate) policy: &'k mut dyn CheckpointPolicy,
    /// The data of checkpoints other than the state; `None` for a run without checkpoints.
    pub(crate) about: Option<About>,
    /// The latest state that was saved.
    pub(crate) last: Option<Saved>,
    /// When the next state is to be saved; `None` for never.
    due: Option<Instant>,
}

impl<'k> Checkpointer<'k> {
    pub(crate) fn new(policy: &'k mut dyn CheckpointPolicy) -> Self {
        let due = Instant::now().checked_add(policy.interval());
        Self { policy, about: None, last: None, due }
    }

    /// Saves the state if that is due after some sweeps, or at the end of a run that is canceled.
    pub(crate) async fn after_sweeps(
        &mut self,
        engine: &mut impl Engine,
        history: &History,
        corrections: impl FnOnce() -> Option<Vec<u64>>,
        period: PeriodSource<'_>,
        is_ending: bool,
    ) -> Result<(), GpuError> {
        let whole = self.about.is_some() && self.policy.wants_checkpoint(is_ending);
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
            let period = period.map(|period| period());
            let (about, saved) = (about.clone(), saved.clone());
            self.policy.checkpoint(Checkpoint { about, saved, period });
        }
        self.last = Some(saved);
        let next = self.policy.interval().max(SHARE * start.elapsed());
        self.due = Instant::now().checked_add(next);
        Ok(())
    }
}
