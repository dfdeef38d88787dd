//! How many of many meshes are done.

use std::path::Path;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use crate::cli::OutputArgs;
use crate::progress::form::Form;
use crate::progress::left::told;
use crate::tell;

/// Shows how many of many meshes are done.
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
    pub(crate) fn new(show: &OutputArgs, meshes: usize) -> Self {
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

    /// Another mesh is done, or failed for a reason.
    pub(crate) fn add(&mut self, mesh: &Path, problem: Option<&str>) {
        self.done += 1;
        self.failed += usize::from(problem.is_some());
        let (done, meshes) = (self.done, self.meshes);
        let took = self.started.elapsed().as_secs_f64();
        let left = took / done as f64 * (meshes - done) as f64;
        if tell::is_json() && self.form != Form::None {
            tell::event(json!({
                "event": "mesh", "mesh": mesh.display().to_string(), "problem": problem, "done": done,
                "meshes": meshes, "seconds_left": left,
            }));
            return;
        }
        let failed = match self.failed {
            0 => String::new(),
            n => format!(", {n} failed"),
        };
        let text = format!("{done} of {meshes} meshes{failed}  about {} left", told(left));
        match self.form {
            Form::None => {}
            _ if self.verbose => {
                let line = format!(
                    "{done} of {meshes}: {}: {}",
                    mesh.display(),
                    problem.unwrap_or("smoothed")
                );
                self.bar.suspend(|| tell::note(false, &line));
            }
            Form::Lines(interval) if self.last_line.elapsed() >= interval && done < meshes => {
                self.last_line = Instant::now();
                tell::note(false, &text);
            }
            Form::Lines(_) | Form::Bar => {}
        }
        self.bar.set_message(text);
        self.bar.set_position(done as u64);
    }

    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}
