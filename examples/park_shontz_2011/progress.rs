//! Progress of the study, with an estimate of the remaining time.

use std::collections::HashMap;
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

use super::store::{RunRecord, Store};
use super::study::{Batch, Case, Place, Setting, Size, Start};

/// Properties that determine the cost of a run.
type Kind = (Setting, Size, Start, Place, String);

/// Counter of runs and their durations.
pub(crate) struct Progress {
    /// Remaining runs of each kind, and the guessed cost of one run in arbitrary units.
    left: HashMap<Kind, (usize, f64)>,
    /// Completed runs of each kind, and their total seconds.
    done: HashMap<Kind, (usize, f64)>,
    total: usize,
    told: Option<Instant>,
}

fn kind(case: &Case) -> Kind {
    (case.setting, case.size, case.start, case.place, case.scheme.clone())
}

/// Guesses the relative cost of a run, for kinds without completed runs.
fn guess(batch: &Batch) -> f64 {
    let size = match batch.size {
        Size::Coarse => 1.0,
        Size::Full => 40.0,
    };
    let sweeps = match batch.start {
        Start::Random if batch.fraction <= 0.95 => 4.0,
        Start::Random => 16.0,
        Start::Smooth => 50.0,
    };
    let differences = if batch.setting == Setting::Published { 6.0 } else { 1.0 };
    size * sweeps * differences * f64::from(batch.inner)
}

impl Progress {
    pub(crate) fn new(cases: &[(&Batch, Case)], store: &Store) -> Self {
        let mut progress =
            Self { left: HashMap::new(), done: HashMap::new(), total: cases.len(), told: None };
        for (batch, case) in cases {
            progress.left.entry(kind(case)).or_insert((0, guess(batch))).0 += 1;
        }
        for run in store.runs() {
            progress.count(run);
        }
        progress
    }

    fn count(&mut self, run: &RunRecord) {
        let kind = kind(&run.case);
        if let Some((left, _)) = self.left.get_mut(&kind) {
            *left = left.saturating_sub(1);
        }
        let (runs, seconds) = self.done.entry(kind).or_default();
        *runs += 1;
        *seconds += run.wall_seconds;
    }

    /// Counts a completed run, and prints the state of the study at intervals.
    pub(crate) fn done(&mut self, run: &RunRecord) {
        self.count(run);
        let terminal = std::io::stderr().is_terminal();
        let pause = Duration::from_millis(if terminal { 200 } else { 10_000 });
        if self.told.is_some_and(|told| told.elapsed() < pause) {
            return;
        }
        self.told = Some(Instant::now());
        let done: usize = self.done.values().map(|(runs, _)| runs).sum();
        let case = &run.case;
        let what = format!(
            "{done} of {} runs, about {} left; {} {} {} {}",
            self.total,
            clock(self.seconds_left()),
            case.setting,
            case.place,
            case.domain,
            case.scheme
        );
        if terminal {
            eprint!("\r{what:<90}");
            let _ = std::io::stderr().flush();
        } else {
            eprintln!("{what}");
        }
    }

    pub(crate) fn end(&self) {
        if self.told.is_some() && std::io::stderr().is_terminal() {
            eprintln!();
        }
    }

    /// Estimates the remaining seconds from the mean duration of each kind of run, or from the guessed cost
    /// for kinds without completed runs.
    fn seconds_left(&self) -> f64 {
        let mut seen = (0.0, 0.0);
        for (kind, (runs, seconds)) in &self.done {
            let guess = self.left.get(kind).map_or(0.0, |(_, guess)| *guess);
            seen = (seen.0 + guess * *runs as f64, seen.1 + seconds);
        }
        let of = |(kind, &(left, guess)): (&Kind, &(usize, f64))| {
            let mean = match self.done.get(kind) {
                Some((runs, seconds)) => seconds / *runs as f64,
                None => guess * seen.1 / f64::max(seen.0, 1.0),
            };
            left as f64 * mean
        };
        self.left.iter().map(of).sum()
    }
}

/// Formats a time in minutes and seconds.
pub(crate) fn clock(seconds: f64) -> String {
    let seconds = seconds.round() as u64;
    match seconds {
        0..60 => format!("{seconds} s"),
        _ => format!("{} min {:02} s", seconds / 60, seconds % 60),
    }
}
