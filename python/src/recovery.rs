//! Recovery of runs: checkpoints in a file, and the change to the CPU if a device fails.

use std::fs;
use std::io::Read;
use std::path::Path;
use std::time::Instant;

use gpu_smooth::{Checkpoint, CheckpointPolicy, GpuError, Stop};
use mesh_io::atomic;
use pyo3::prelude::*;

use crate::error;
use crate::observer::RunObserver;
use crate::run_options::CheckpointPlan;

/// Reads the checkpoint from which a run continues.
pub(crate) fn resumed(py: Python<'_>, path: &Path) -> PyResult<Checkpoint> {
    let bytes = fs::read(path).map_err(|error| {
        error::file(
            py,
            &format!("resume: {}: {error}. A completed run removes its checkpoint", path.display()),
        )
    })?;
    Checkpoint::from_bytes(&bytes).map_err(|problem| {
        let path = path.display();
        let text = format!("resume: {path}: {problem}. Without resume, the run starts anew");
        error::file(py, &text)
    })
}

/// Refuses to replace an existing file by checkpoints, unless the run continues from this file.
pub(crate) fn check(
    py: Python<'_>,
    plan: &CheckpointPlan,
    continued: Option<&Path>,
) -> PyResult<()> {
    let file = &plan.file;
    if !file.exists() || continued.is_some_and(|from| is_same(from, file)) {
        return Ok(());
    }
    let name = file.display();
    let text = match is_checkpoint(file) {
        true => format!(
            "checkpoint: {name} is the checkpoint of another run. Continue that run by resume, or remove the file"
        ),
        false => {
            format!("checkpoint: {name} exists and is no checkpoint. Choose the name of a new file")
        }
    };
    Err(error::file(py, &text))
}

fn is_same(a: &Path, b: &Path) -> bool {
    a == b || matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

fn is_checkpoint(path: &Path) -> bool {
    let mut head = [0; Checkpoint::MAGIC.len()];
    fs::File::open(path).and_then(|mut file| file.read_exact(&mut head)).is_ok()
        && head == *Checkpoint::MAGIC
}

/// Saves the checkpoints of a run, and decides whether the run leaves a device that fails.
pub(crate) struct Recovery<'a> {
    plan: Option<&'a CheckpointPlan>,
    /// Time of the next checkpoint.
    due: Option<Instant>,
    falls_back: bool,
    observer: &'a RunObserver<'a>,
}

impl<'a> Recovery<'a> {
    pub(crate) fn new(
        plan: Option<&'a CheckpointPlan>,
        falls_back: bool,
        observer: &'a RunObserver<'a>,
    ) -> Self {
        let due = plan.and_then(|plan| Instant::now().checked_add(plan.every));
        Self { plan, due, falls_back, observer }
    }
}

impl CheckpointPolicy for Recovery<'_> {
    fn wants_checkpoint(&mut self, is_ending: bool) -> bool {
        self.plan.is_some() && (is_ending || self.due.is_some_and(|due| Instant::now() >= due))
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) {
        let Some(plan) = self.plan else { return };
        if let Err(error) = atomic::write(&plan.file, &checkpoint.to_bytes()) {
            let text = format!("no checkpoint was saved: {error}. The run goes on");
            self.observer.warn(&text);
        }
        self.due = Instant::now().checked_add(plan.every);
    }

    fn falls_back_to_cpu(&mut self, _: &GpuError, _: u32) -> bool {
        self.falls_back
    }
}

/// Removes the checkpoint of a completed run.
pub(crate) fn clear(plan: Option<&CheckpointPlan>, stop: Stop) {
    if let Some(CheckpointPlan { file, .. }) = plan
        && stop != Stop::Canceled
        && is_checkpoint(file)
    {
        // A checkpoint that cannot be removed does no harm.
        let _ = fs::remove_file(file);
    }
}
