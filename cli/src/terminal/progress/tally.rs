//! Progress of a run on many meshes.

use std::path::Path;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use crate::terminal::Verbosity;
use crate::terminal::progress::form::Form;
use crate::terminal::progress::left::duration_text;
use crate::terminal::tell;

/// Display of the number of finished meshes, on standard error.
pub(crate) struct Tally {
    form: Form,
    bar: ProgressBar,
    started: Instant,
    last_line: Instant,
    verbose: bool,
    meshes: usize,
    done: usize,
    failed: usize,
}

impl Tally {
    pub(crate) fn new(show: Verbosity, meshes: usize) -> Self {
        let (form, now) = (Form::new(show), Instant::now());
        let bar = form.bar();
        if let Ok(style) = ProgressStyle::with_template("{bar:16} {wide_msg}") {
            bar.set_style(style);
        }
        bar.set_message(format!("0 of {meshes} meshes"));
        bar.set_length(meshes as u64);
        Self {
            form,
            bar,
            started: now,
            last_line: now,
            verbose: show.verbose,
            meshes,
            done: 0,
            failed: 0,
        }
    }

    /// Counts another mesh. `problem` is the reason of a failure, `None` for a success; `text` describes
    /// the result in one line.
    pub(crate) fn add(&mut self, mesh: &Path, problem: Option<&str>, text: &str) {
        self.done += 1;
        self.failed += usize::from(problem.is_some());
        let (done, meshes) = (self.done, self.meshes);
        if tell::is_json() && self.form != Form::None {
            return tell::event(json!({
                "event": "mesh", "mesh": mesh.display().to_string(), "problem": problem, "done": done,
                "meshes": meshes, "seconds_left": self.left(),
            }));
        }
        if self.verbose && self.form != Form::None {
            let line = format!("{done} of {meshes}: {}: {text}", mesh.display());
            self.bar.suspend(|| tell::note(false, &line));
        }
        self.bar.set_position(done as u64);
        self.waits();
    }

    /// Updates the elapsed and the estimated remaining time of the whole command.
    pub(crate) fn waits(&mut self) {
        match self.form {
            Form::Bar => self.bar.set_message(self.text()),
            Form::Lines(interval) if !self.verbose && self.last_line.elapsed() >= interval => {
                self.last_line = Instant::now();
                if !tell::is_json() {
                    tell::note(false, &self.text());
                }
            }
            Form::Lines(_) | Form::None => {}
        }
    }

    /// Estimates the seconds until all meshes are finished; `None` before the first mesh is finished.
    fn left(&self) -> Option<f64> {
        let took = self.started.elapsed().as_secs_f64();
        let left = took / self.done as f64 * (self.meshes - self.done) as f64;
        (self.done > 0).then_some(left)
    }

    fn text(&self) -> String {
        let mut text = format!("{} of {} meshes", self.done, self.meshes);
        if self.failed > 0 {
            text += &format!(", {} failed", self.failed);
        }
        text += &format!("  {}", duration_text(self.started.elapsed().as_secs_f64()));
        if let Some(left) = self.left().filter(|left| *left > 0.5) {
            text += &format!(", about {} left", duration_text(left));
        }
        text
    }

    /// Hides the bar during a call of `print`.
    pub(crate) fn aside(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}
