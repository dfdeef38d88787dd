//! The terminal: messages, progress, signals, panics and the words of the process.

pub(crate) mod interrupt;
pub(crate) mod numbers;
pub(crate) mod panics;
pub(crate) mod process;
pub(crate) mod progress;
mod requested;
pub(crate) mod shell_words;
pub(crate) mod tell;
pub(crate) mod threads;
mod verbosity;

pub(crate) use verbosity::Verbosity;
