//! The words by which this process was started, and those that start the program again.

use std::ffi::OsString;
use std::sync::{Mutex, PoisonError};

/// The words of the process.
#[derive(Clone)]
struct Words {
    /// The command line, with the name of the program first.
    line: Vec<OsString>,
    /// The program, without arguments.
    program: Vec<OsString>,
}

static WORDS: Mutex<Words> = Mutex::new(Words { line: Vec::new(), program: Vec::new() });

/// Stores the command line of the process, and the words that start the program again.
pub(crate) fn start(line: Vec<OsString>, program: Vec<OsString>) {
    *WORDS.lock().unwrap_or_else(PoisonError::into_inner) = Words { line, program };
}

/// Returns the words of the command line, with the name of the program first.
pub(crate) fn command_line() -> Vec<OsString> {
    WORDS.lock().unwrap_or_else(PoisonError::into_inner).line.clone()
}

/// Returns the words that start the program again, without arguments. Empty if they are unknown.
pub(crate) fn program() -> Vec<OsString> {
    WORDS.lock().unwrap_or_else(PoisonError::into_inner).program.clone()
}
