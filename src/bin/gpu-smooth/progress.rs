//! The bar on the terminal during long runs.

use std::time::{Duration, Instant};

use gpu_smooth::{Phase, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A run shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_millis(700);

/// Shows sweeps, f and speed on standard error, if that is a terminal and the run takes a while.
pub(crate) struct Bar {
    started: Instant,
    phase: Option<Phase>,
    bar: ProgressBar,
    max_sweeps: u32,
}

impl Bar {
    pub(crate) fn new(quiet: bool, max_sweeps: u32) -> Self {
        // Drawing to standard error is a no-op where that is not a terminal.
        let target =
            if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(None, target);
        Self { started: Instant::now(), phase: None, bar, max_sweeps }
    }

    pub(crate) fn update(&mut self, progress: &Progress) {
        if self.started.elapsed() < PATIENCE {
            return;
        }
        if self.phase != Some(progress.phase) {
            self.phase = Some(progress.phase);
            let template = match progress.phase {
                Phase::Reference => "finding the optimum: sweep {pos}  {msg}  {per_sec}",
                Phase::Smoothing => "{bar:24} sweep {pos}/{len}  {msg}  {per_sec}  {elapsed}",
            };
            if let Ok(style) = ProgressStyle::with_template(template) {
                let per_second = |state: &indicatif::ProgressState,
                                  out: &mut dyn std::fmt::Write| {
                    let _ = write!(out, "{:.0} sweeps/s", state.per_sec());
                };
                self.bar.set_style(style.with_key("per_sec", per_second));
            }
            self.bar.set_length(self.max_sweeps.into());
            self.bar.reset();
        }
        self.bar.set_message(format!("f {:.7}", progress.f));
        self.bar.set_position(progress.sweep.into());
    }

    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}
