//! The bar on the terminal during long runs.

use std::io::IsTerminal;
use std::path::Path;
use std::time::{Duration, Instant};

use gpu_smooth::{Phase, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::cli::OutputArgs;
use crate::tell;

/// A run shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_millis(700);
/// Time between lines where there is no bar.
const INTERVAL: Duration = Duration::from_secs(1);

/// Shows sweeps, f and speed on standard error if the run takes a while: as a bar if that is a terminal, else as lines
/// where the user wants every sweep.
pub(crate) struct Bar {
    started: Instant,
    /// The phase of the run, and when it began.
    phase: Option<(Phase, Instant)>,
    bar: ProgressBar,
    /// When the next line is due, if there are lines.
    next_line: Option<Instant>,
    max_sweeps: u32,
}

impl Bar {
    pub(crate) fn new(show: &OutputArgs, max_sweeps: u32) -> Self {
        // Drawing to standard error is a no-op where that is not a terminal.
        let target =
            if show.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(max_sweeps.into()), target);
        let started = Instant::now();
        let lines = show.verbose && !std::io::stderr().is_terminal();
        Self { started, phase: None, bar, next_line: lines.then_some(started), max_sweeps }
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
        if let Some(due) = &mut self.next_line {
            if *due <= Instant::now() {
                tell::note(false, &message);
                *due = Instant::now() + INTERVAL;
            }
            return;
        }
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

/// Shows how many of many meshes are done.
pub(crate) struct Tally {
    bar: ProgressBar,
    verbose: bool,
    failed: usize,
}

impl Tally {
    pub(crate) fn new(show: &OutputArgs, meshes: usize) -> Self {
        let target =
            if show.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(meshes as u64), target);
        if let Ok(style) =
            ProgressStyle::with_template("{bar:24} {pos}/{len} meshes{msg}  {eta} left")
        {
            bar.set_style(style);
        }
        Self { bar, verbose: show.verbose, failed: 0 }
    }

    /// Another mesh is done, or failed for a reason.
    pub(crate) fn add(&mut self, mesh: &Path, problem: Option<&str>) {
        if problem.is_some() {
            self.failed += 1;
            self.bar.set_message(format!(", {} failed", self.failed));
        }
        self.bar.inc(1);
        if self.verbose {
            let text = problem.unwrap_or("smoothed");
            let line = format!(
                "{} of {}: {}: {text}",
                self.bar.position(),
                self.bar.length().unwrap_or_default(),
                mesh.display()
            );
            self.bar.suspend(|| tell::note(false, &line));
        }
    }

    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}
