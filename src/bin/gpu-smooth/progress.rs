//! The bar on the terminal during long runs.

use std::time::{Duration, Instant};

use gpu_smooth::{Phase, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A run shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_millis(700);

/// Shows sweeps, f and speed on standard error, if that is a terminal and the run takes a while.
pub(crate) struct Bar {
    started: Instant,
    /// And when it began.
    phase: Option<(Phase, Instant)>,
    bar: ProgressBar,
    max_sweeps: u32,
}

impl Bar {
    pub(crate) fn new(quiet: bool, max_sweeps: u32) -> Self {
        // Drawing to standard error is a no-op where that is not a terminal.
        let target =
            if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(max_sweeps.into()), target);
        Self { started: Instant::now(), phase: None, bar, max_sweeps }
    }

    pub(crate) fn update(&mut self, progress: &Progress) {
        let began = match self.phase {
            Some((phase, began)) if phase == progress.phase => began,
            before => {
                let began = if before.is_none() { self.started } else { Instant::now() };
                self.phase = Some((progress.phase, began));
                began
            }
        };
        if self.started.elapsed() < PATIENCE {
            return;
        }
        let (sweep, seconds) = (progress.sweep, began.elapsed().as_secs_f64());
        let speed = f64::from(sweep) / seconds.max(1e-3);
        let figures = format!("f {:.7}  {speed:.0} sweeps/s  {seconds:.0} s", progress.f);
        let (template, message) = match progress.phase {
            Phase::Reference => ("{msg}", format!("finding the optimum: sweep {sweep}  {figures}")),
            Phase::Smoothing => {
                ("{bar:24} {msg}", format!("sweep {sweep}/{}  {figures}", self.max_sweeps))
            }
        };
        if let Ok(style) = ProgressStyle::with_template(template) {
            self.bar.set_style(style);
        }
        self.bar.set_message(message);
        self.bar.set_position(sweep.into());
    }

    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}
