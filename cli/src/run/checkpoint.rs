//! Recovery of long runs: checkpoints, and the change of engine if a device fails.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use gpu_smooth::{Checkpoint, CheckpointError, CheckpointPolicy, GpuError};
use gpu_smooth_job::{CheckpointFile, CheckpointWriter};

use crate::error::CliError;
use crate::run::engine;
use crate::run::observer::PipelineObserver;

const WITHOUT_CONTINUE: &str = "Without --continue the run starts anew";

/// Reads the checkpoint from which the run continues; `None` without `--continue`.
pub(crate) fn resumed(continue_from: Option<&Path>) -> Result<Option<Checkpoint>, CliError> {
    let Some(path) = continue_from else { return Ok(None) };
    let name = path.display();
    let bytes = fs::read(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => CliError::input(format!(
            "{name}: the file does not exist. A completed run removes its checkpoint"
        ))
        .with_remedy(WITHOUT_CONTINUE),
        _ => CliError::input(format!("{name}: {error}")),
    })?;
    Checkpoint::from_bytes(&bytes).map(Some).map_err(|error| {
        let remedy = match &error {
            CheckpointError::Version { writer } => {
                format!("Continue the run by {writer}. {WITHOUT_CONTINUE}")
            }
            _ => WITHOUT_CONTINUE.to_owned(),
        };
        CliError::input(format!("{name}: {error}")).with_remedy(remedy)
    })
}

/// Saver of the checkpoints of a run, as `--checkpoint` and `--checkpoint-every` request.
pub(crate) struct CheckpointSaver<'a, 'f> {
    writer: CheckpointWriter<'a>,
    follow: &'a Mutex<&'f mut dyn PipelineObserver>,
    told_of_fault: bool,
}

impl<'a, 'f> CheckpointSaver<'a, 'f> {
    pub(crate) fn new(
        plan: Option<&'a CheckpointFile>,
        follow: &'a Mutex<&'f mut dyn PipelineObserver>,
    ) -> Self {
        Self { writer: CheckpointWriter::new(plan), follow, told_of_fault: false }
    }

    /// Passes a remark on to the user.
    fn remark(&self, text: &str) {
        self.follow.lock().unwrap_or_else(PoisonError::into_inner).remark(text);
    }

    /// Tells the user how to continue a canceled run, if a checkpoint was saved.
    pub(crate) fn left(&self) {
        if let Some(path) = self.writer.saved() {
            self.remark(&format!("to continue the run, add --continue {}", path.display()));
        }
    }
}

impl CheckpointPolicy for CheckpointSaver<'_, '_> {
    fn wants_checkpoint(&mut self, is_ending: bool) -> bool {
        self.writer.is_due(is_ending)
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) {
        if let Err(error) = self.writer.save(&checkpoint) {
            self.remark(&format!("no checkpoint was saved: {error}. The run goes on"));
        }
    }

    fn falls_back_to_cpu(&mut self, error: &GpuError, from: u32) -> bool {
        // Before the first sweep, no progress would be lost. The caller then chooses the CPU if the engine was left
        // open, or refuses the mesh.
        if from == 0 && engine::is_too_large_for_device(error) {
            return false;
        }
        if !std::mem::replace(&mut self.told_of_fault, true) {
            let text =
                format!("the GPU failed: {error}. The run goes on on the CPU, from sweep {from}");
            self.remark(&text);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::LoadedMesh;
    use crate::terminal::progress::Stage;
    use gpu_smooth::Progress;

    /// An observer that collects remarks.
    #[derive(Default)]
    struct Remarks(Vec<String>);

    impl PipelineObserver for Remarks {
        fn stage(&mut self, _: Stage) {}

        fn has_read(
            &mut self,
            _: &LoadedMesh,
            _: Option<&mesh_io::Conversion>,
        ) -> Result<(), CliError> {
            Ok(())
        }

        fn remark(&mut self, text: &str) {
            self.0.push(text.to_owned());
        }

        fn sweep(&mut self, _: &Progress) {}

        fn has_smoothed(&mut self) -> Result<(), CliError> {
            Ok(())
        }
    }

    #[test]
    fn the_cpu_takes_over_once_from_a_failed_device_but_not_at_a_start_without_memory() {
        let mut remarks = Remarks::default();
        let follow: Mutex<&mut dyn PipelineObserver> = Mutex::new(&mut remarks);
        let mut kept = CheckpointSaver::new(None, &follow);
        assert!(!kept.falls_back_to_cpu(&GpuError::OutOfMemory("full".into()), 0));
        assert!(kept.falls_back_to_cpu(&GpuError::OutOfMemory("full".into()), 7));
        assert!(kept.falls_back_to_cpu(&GpuError::Lost("gone".into()), 0));
        assert!(!kept.wants_checkpoint(true), "no file was named");
        let expected = "the GPU failed: the device is out of memory: full. The run goes on on the CPU, from sweep 7";
        assert_eq!(remarks.0, [expected]);
    }
}
