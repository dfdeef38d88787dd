//! Chooses how progress is shown.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget};

use crate::terminal::Verbosity;
use crate::terminal::tell;

/// Runs shorter than this show no progress.
pub(crate) const PATIENCE: Duration = Duration::from_millis(700);

/// How progress is shown.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Form {
    /// Not at all.
    None,
    /// As a bar on the last line of a terminal.
    Bar,
    /// As a line on standard error now and then.
    Lines(Duration),
}

impl Form {
    pub(crate) fn new(show: Verbosity) -> Self {
        let seconds = if show.verbose { 1 } else { 5 };
        match () {
            () if show.quiet => Self::None,
            () if std::io::stderr().is_terminal() && !tell::is_json() => Self::Bar,
            () => Self::Lines(Duration::from_secs(seconds)),
        }
    }

    pub(crate) fn bar(self) -> ProgressBar {
        let target = match self {
            Self::Bar => ProgressDrawTarget::stderr(),
            Self::None | Self::Lines(_) => ProgressDrawTarget::hidden(),
        };
        ProgressBar::with_draw_target(Some(1000), target)
    }
}
