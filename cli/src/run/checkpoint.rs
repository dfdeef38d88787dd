//! Keeps what a long run needs to go on: checkpoints, and another engine if a device fails.

use std::cell::{Cell, RefCell};
use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::Path;
use std::time::Instant;

use gpu_smooth::{Checkpoint, GpuError, Keeper, Stop};
use mesh_io::atomic;

use crate::args::SmoothArgs;
use crate::error::CliError;
use crate::run::engine;
use crate::run::observer::Follow;

/// Returns the file that checkpoints are saved to: that of `--checkpoint`, else that of `--continue`, if either is
/// given.
pub(crate) fn file(args: &SmoothArgs) -> Option<&Path> {
    args.checkpoint.as_deref().or(args.continued.as_deref())
}

/// Refuses a file for checkpoints that cannot be written, or that would replace one of the other files or the
/// checkpoint of another run.
pub(crate) fn check<'p>(
    args: &SmoothArgs,
    mut others: impl Iterator<Item = &'p Path>,
) -> Result<(), CliError> {
    let Some(path) = file(args) else { return Ok(()) };
    let name = path.display();
    if others.any(|other| atomic::same_file(other, path)) {
        return Err(CliError::output(format!("{name}: the checkpoint would replace this file"))
            .with_remedy("Give --checkpoint another name"));
    }
    let is_continued = args.continued.as_deref().is_some_and(|from| atomic::same_file(from, path));
    match begins(path) {
        _ if is_continued => {}
        None => {}
        Some(true) => {
            let text = format!("{name}: this file is the checkpoint of another run");
            return Err(CliError::output(text).with_remedy(format!("Go on with that run by --continue {name} (with --engine cpu as well, if the driver of a GPU ended it), or remove the file")));
        }
        Some(false) => {
            return Err(CliError::output(format!("{name}: exists and is not a checkpoint"))
                .with_remedy("Give --checkpoint another name"));
        }
    }
    atomic::check(path).map_err(|error| CliError::from(error).within("checkpoints cannot be saved"))
}

/// Whether the file at a path begins as a checkpoint does; `None` if there is none.
fn begins(path: &Path) -> Option<bool> {
    let mut start = [0; Checkpoint::MAGIC.len()];
    let read = File::open(path).ok()?.read_exact(&mut start);
    Some(read.is_ok() && start == *Checkpoint::MAGIC)
}

const WITHOUT_CONTINUE: &str = "Without --continue the run starts anew";

/// Reads the checkpoint to go on from, if the command line names one.
pub(crate) fn resumed(args: &SmoothArgs) -> Result<Option<Checkpoint>, CliError> {
    let Some(path) = &args.continued else { return Ok(None) };
    let name = path.display();
    let bytes = fs::read(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => CliError::input(format!(
            "{name}: there is no such file. A run that came to its end has removed its checkpoint"
        ))
        .with_remedy(WITHOUT_CONTINUE),
        _ => CliError::input(format!("{name}: {error}")),
    })?;
    let refused = || {
        CliError::input(format!(
            "{name}: not a checkpoint of this version of gpu-smooth, or damaged"
        ))
        .with_remedy(WITHOUT_CONTINUE)
    };
    Checkpoint::from_bytes(&bytes).map(Some).ok_or_else(refused)
}

/// Keeps the state of a run as the command line asks.
pub(crate) struct Kept<'a, 'f> {
    args: &'a SmoothArgs,
    follow: &'a RefCell<&'f mut dyn Follow>,
    /// When the next checkpoint is due; `None` if never.
    due: Option<Instant>,
    /// Whether there is a checkpoint of this run in its file.
    saved: Cell<bool>,
    told_of_fault: bool,
}

impl<'a, 'f> Kept<'a, 'f> {
    pub(crate) fn new(args: &'a SmoothArgs, follow: &'a RefCell<&'f mut dyn Follow>) -> Self {
        let due = Instant::now().checked_add(args.checkpoint_every);
        Self { args, follow, due, saved: Cell::new(false), told_of_fault: false }
    }

    /// Tells the user how to go on with a run that was left.
    pub(crate) fn left(&self) {
        if let (true, Some(path)) = (self.saved.get(), file(self.args)) {
            let text =
                format!("to go on with the run from here, add --continue {}", path.display());
            self.follow.borrow_mut().remark(&text);
        }
    }
}

impl Keeper for Kept<'_, '_> {
    fn wants_checkpoint(&mut self, is_ending: bool) -> bool {
        file(self.args).is_some()
            && (is_ending || self.due.is_some_and(|due| Instant::now() >= due))
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) {
        let Some(path) = file(self.args) else { return };
        match atomic::replace(path, &checkpoint.to_bytes()) {
            Ok(()) => self.saved.set(true),
            Err(error) => {
                let text = format!("no checkpoint was saved: {error}. The run goes on");
                self.follow.borrow_mut().remark(&text);
            }
        }
        self.due = Instant::now().checked_add(self.args.checkpoint_every);
    }

    fn goes_on_without(&mut self, error: &GpuError, from: u32) -> bool {
        // Before the first sweep there is nothing to go on with. The caller then takes the CPU if the choice of engine
        // was left open, or refuses the mesh.
        if from == 0 && engine::is_too_large_for_device(error) {
            return false;
        }
        if !std::mem::replace(&mut self.told_of_fault, true) {
            let text =
                format!("the GPU failed: {error}. The run goes on on the CPU, from sweep {from}");
            self.follow.borrow_mut().remark(&text);
        }
        true
    }
}

/// Removes the checkpoint of a run whose mesh is written, unless the run was left before its end.
pub(crate) fn clear(args: &SmoothArgs, stop: Stop) {
    let Some(path) = file(args) else { return };
    if stop != Stop::Canceled && begins(path) == Some(true) {
        // A checkpoint that is left does no harm.
        let _ = fs::remove_file(path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::Cli;
    use crate::load::LoadedMesh;
    use crate::terminal::progress::Stage;
    use clap::Parser;
    use gpu_smooth::Progress;

    /// Collects remarks.
    #[derive(Default)]
    struct Remarks(Vec<String>);

    impl Follow for Remarks {
        fn stage(&mut self, _: Stage) {}

        fn has_read(&mut self, _: &LoadedMesh) -> Result<(), CliError> {
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
        let cli = Cli::try_parse_from(["gpu-smooth", "in", "out"]).unwrap();
        let mut remarks = Remarks::default();
        let follow: RefCell<&mut dyn Follow> = RefCell::new(&mut remarks);
        let mut kept = Kept::new(&cli.smooth, &follow);
        assert!(!kept.goes_on_without(&GpuError::OutOfMemory("full".into()), 0));
        assert!(kept.goes_on_without(&GpuError::OutOfMemory("full".into()), 7));
        assert!(kept.goes_on_without(&GpuError::Lost("gone".into()), 0));
        assert!(!kept.wants_checkpoint(true), "no file was named");
        let told = "the GPU failed: the device is out of memory: full. The run goes on on the CPU, from sweep 7";
        assert_eq!(remarks.0, [told]);
    }
}
