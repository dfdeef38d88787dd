//! The command line of the wheel.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command line `words`, whose first word is the name of the program, and returns the exit code. `program` are the
/// words that start the program again.
///
/// Python's lock is released, so that handlers of signals of the command line work while Python's would wait.
#[pyfunction]
pub(crate) fn command_line(py: Python<'_>, words: Vec<OsString>, program: Vec<OsString>) -> u8 {
    py.detach(|| gpu_smooth_cli::main_with(words, program))
}
