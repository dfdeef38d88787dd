//! The options of a run: those of the table, and the options that the Python package alone has.

use std::ops::Deref;
use std::path::{Path, PathBuf};

use gpu_smooth_job::CheckpointFile;
use gpu_smooth_job::options::{Belongs, GivenOptions, OPTIONS};
use pyo3::prelude::*;

use crate::error;
use crate::values::{self, Given};

/// Names of the options of a run that are not in the table.
const OWN: [&str; 3] = ["on_sweep", "checkpoint", "resume"];

/// Returns the names of the options of a run.
pub(crate) fn names() -> Vec<String> {
    of_table(Belongs::ToRun).chain(OWN.map(str::to_owned)).collect()
}

/// Returns the names of the options in the table that belong to a mesh or to a run.
pub(crate) fn of_table(belongs: Belongs) -> impl Iterator<Item = String> {
    let rows = OPTIONS.iter().filter(move |row| row.belongs == belongs);
    rows.map(|row| row.name.replace('-', "_"))
}

/// The options of a run.
#[derive(Default)]
pub(crate) struct RunOptions {
    given: GivenOptions,
    on_sweep: Option<Py<PyAny>>,
    checkpoint: Option<PathBuf>,
    resume: Option<PathBuf>,
}

impl Deref for RunOptions {
    type Target = GivenOptions;

    fn deref(&self) -> &GivenOptions {
        &self.given
    }
}

impl RunOptions {
    /// Sets an option. Returns false if no option of a run has the name.
    pub(crate) fn set(&mut self, given: Given<'_, '_>) -> PyResult<bool> {
        let row = GivenOptions::row(given.name).filter(|row| row.belongs == Belongs::ToRun);
        match (given.name, row) {
            (_, Some(row)) => given.set(row, &mut self.given)?,
            ("on_sweep", _) => {
                if !given.value.is_callable() {
                    return Err(given.refused("a function of one argument"));
                }
                self.on_sweep = Some(given.value.clone().unbind());
            }
            ("checkpoint", _) => self.checkpoint = Some(given.path()?),
            ("resume", _) => self.resume = Some(given.path()?),
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Sets an option of `function`, which has no other options. None is the default of each option.
    pub(crate) fn set_named(
        &mut self,
        name: &Bound<'_, PyAny>,
        value: &Bound<'_, PyAny>,
        function: &str,
    ) -> PyResult<()> {
        let name: String = name.extract()?;
        let is_known = match value.is_none() {
            true => names().contains(&name),
            false => self.set(Given { name: &name, value })?,
        };
        match is_known {
            true => Ok(()),
            false => Err(values::unknown(&name, function, &names())),
        }
    }

    /// Checks for an option that needs a checkpoint.
    pub(crate) fn check(&self, py: Python<'_>) -> PyResult<()> {
        match self.has("checkpoint-every") && self.checkpoint_file().is_none() {
            true => Err(error::option(
                py,
                "checkpoint_every needs checkpoint or resume. Pass the file of the checkpoints, or drop checkpoint_every",
            )),
            false => Ok(()),
        }
    }

    /// Returns the file of the run's checkpoints.
    pub(crate) fn checkpoint_file(&self) -> Option<CheckpointFile> {
        let every = self.settings().checkpoint_every;
        CheckpointFile::of(self.checkpoint.clone(), self.resume.clone(), every)
    }

    /// Returns the file of the checkpoint from which the run continues.
    pub(crate) fn resume(&self) -> Option<&Path> {
        self.resume.as_deref()
    }

    /// Returns the function that is called during the run.
    pub(crate) fn on_sweep(&self) -> Option<&Py<PyAny>> {
        self.on_sweep.as_ref()
    }
}
