//! Choice between a progress bar, lines of text, and silence.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget};

use crate::terminal::Verbosity;
use crate::terminal::tell;

/// Time before progress is shown. Shorter runs show none.
pub(crate) const PATIENCE: Duration = Duration::from_millis(700);

/// Display of progress on standard error.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Form {
    /// No display.
    None,
    /// A progress bar on the terminal's last line.
    Bar,
    /// A line of text after each interval.
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
