//! Recovery of runs: checkpoints in a file, and the change to the CPU if a device fails.

use std::fs;
use std::path::Path;

use gpu_smooth::{Checkpoint, CheckpointPolicy, GpuError};
use gpu_smooth_job::{CheckpointFile, CheckpointWriter, Occupant};
use pyo3::prelude::*;

use crate::error;
use crate::observer::RunObserver;

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
    plan: &CheckpointFile,
    continued: Option<&Path>,
) -> PyResult<()> {
    let name = plan.file.display();
    let text = match Occupant::of(&plan.file, continued) {
        None => return Ok(()),
        Some(Occupant::OtherRun) => format!(
            "checkpoint: {name} is the checkpoint of another run. Continue that run by resume, or remove the file"
        ),
        Some(Occupant::OtherKind) => {
            format!("checkpoint: {name} exists and is no checkpoint. Choose the name of a new file")
        }
    };
    Err(error::file(py, &text))
}

/// Saves the checkpoints of a run, and decides whether the run leaves a device that fails.
pub(crate) struct Recovery<'a> {
    writer: CheckpointWriter<'a>,
    falls_back: bool,
    observer: &'a RunObserver<'a>,
}

impl<'a> Recovery<'a> {
    pub(crate) fn new(
        file: Option<&'a CheckpointFile>,
        falls_back: bool,
        observer: &'a RunObserver<'a>,
    ) -> Self {
        Self { writer: CheckpointWriter::new(file), falls_back, observer }
    }
}

impl CheckpointPolicy for Recovery<'_> {
    fn wants_checkpoint(&mut self, is_ending: bool) -> bool {
        self.writer.is_due(is_ending)
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) {
        if let Err(error) = self.writer.save(&checkpoint) {
            self.observer.warn(&format!("no checkpoint was saved: {error}. The run goes on"));
        }
    }

    fn falls_back_to_cpu(&mut self, _: &GpuError, _: u32) -> bool {
        self.falls_back
    }
}
