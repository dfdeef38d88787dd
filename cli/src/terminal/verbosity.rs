//! Amount of output of a command.

/// Amount of output of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Verbosity {
    /// Whether nothing is printed but errors and the answer of the command.
    pub(crate) quiet: bool,
    /// Whether every sweep is printed.
    pub(crate) verbose: bool,
}
