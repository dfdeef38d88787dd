//! The file of a run's checkpoints.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use gpu_smooth::{Checkpoint, Stop};
use mesh_io::{WriteError, atomic};

/// The time between two checkpoints, if the user gives none.
const BETWEEN: Duration = Duration::from_secs(300);

/// The file of a run's checkpoints, and the time between two checkpoints.
#[derive(Clone, Debug)]
pub struct CheckpointFile {
    /// The file, which each checkpoint replaces.
    pub file: PathBuf,
    /// The time between two checkpoints.
    pub every: Duration,
}

impl CheckpointFile {
    /// Returns the file of a run's checkpoints. A continued run saves its checkpoints to the file that it continues from,
    /// unless another file is named. `None` for a run without checkpoints.
    pub fn of(
        checkpoint: Option<PathBuf>,
        continued: Option<PathBuf>,
        every: Option<Duration>,
    ) -> Option<Self> {
        let file = checkpoint.or(continued)?;
        Some(Self { file, every: every.unwrap_or(BETWEEN) })
    }

    /// Removes the checkpoint of a run that ended for the reason `stop`, once its mesh is written. The checkpoint of a canceled
    /// run stays, and so does a file that is no checkpoint.
    pub fn clear(&self, stop: Stop) {
        if stop != Stop::Canceled && is_checkpoint(&self.file) {
            // A checkpoint that cannot be removed does no harm.
            let _ = fs::remove_file(&self.file);
        }
    }
}

/// A file that checkpoints of a run must not replace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occupant {
    /// A checkpoint of another run.
    OtherRun,
    /// A file that is no checkpoint.
    OtherKind,
}

impl Occupant {
    /// Returns the file at `path` that checkpoints must not replace; `None` if the path is free, or if the run continues from
    /// this file.
    pub fn of(path: &Path, continued: Option<&Path>) -> Option<Self> {
        if !path.exists() || continued.is_some_and(|from| atomic::same_file(from, path)) {
            return None;
        }
        Some(if is_checkpoint(path) { Self::OtherRun } else { Self::OtherKind })
    }
}

/// Returns whether a file exists and begins as checkpoints do.
fn is_checkpoint(path: &Path) -> bool {
    let mut head = [0; Checkpoint::MAGIC.len()];
    fs::File::open(path).and_then(|mut file| file.read_exact(&mut head)).is_ok()
        && head == *Checkpoint::MAGIC
}

/// Saves the checkpoints of a run to its file, each after the time between two checkpoints, and one at the end of a canceled
/// run. For the methods of a [`CheckpointPolicy`](gpu_smooth::CheckpointPolicy).
#[derive(Debug)]
pub struct CheckpointWriter<'a> {
    /// `None` if no checkpoint is saved.
    file: Option<&'a CheckpointFile>,
    /// Time of the next checkpoint; `None` if no checkpoint will be saved.
    due: Option<Instant>,
    has_saved: bool,
}

impl<'a> CheckpointWriter<'a> {
    /// Begins a run, without checkpoints if `file` is `None`.
    pub fn new(file: Option<&'a CheckpointFile>) -> Self {
        let due = file.and_then(|file| Instant::now().checked_add(file.every));
        Self { file, due, has_saved: false }
    }

    /// Returns whether a checkpoint is due. `is_ending` tells whether the run is canceled now.
    pub fn is_due(&self, is_ending: bool) -> bool {
        self.file.is_some() && (is_ending || self.due.is_some_and(|due| Instant::now() >= due))
    }

    /// Saves a checkpoint, which replaces the one before.
    ///
    /// # Errors
    /// [`WriteError`] if the file cannot be written. The checkpoint before then stays.
    pub fn save(&mut self, checkpoint: &Checkpoint) -> Result<(), WriteError> {
        let Some(CheckpointFile { file, every }) = self.file else { return Ok(()) };
        let written = atomic::write(file, &checkpoint.to_bytes());
        self.has_saved |= written.is_ok();
        self.due = Instant::now().checked_add(*every);
        written
    }

    /// Returns the file if it holds a checkpoint of this run.
    pub fn saved(&self) -> Option<&'a Path> {
        self.file.filter(|_| self.has_saved).map(|file| &*file.file)
    }
}
