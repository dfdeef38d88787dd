//! Choice between a progress bar, lines of text, and silence.

use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget};

use crate::terminal::Verbosity;
use crate::terminal::tell;

/// Time before progress is shown. Shorter runs show none.
pub(crate) const PATIENCE: Duration = Duration::from_millis(700);

/// The progress bar of the current command. A signal removes the bar.
static LAST_BAR: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// Removes the progress bar from the terminal for good. Does nothing without a progress bar.
pub(crate) fn remove_bar() {
    let bar = LAST_BAR.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
}

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
        let bar = ProgressBar::with_draw_target(Some(1000), target);
        *LAST_BAR.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar.clone());
        bar
    }
}
