//! How much a command prints.

/// How much a command prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Verbosity {
    /// Whether errors alone are printed, and the answer of the command.
    pub(crate) quiet: bool,
    /// Whether every sweep is printed.
    pub(crate) verbose: bool,
}
