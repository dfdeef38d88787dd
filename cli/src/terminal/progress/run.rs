//! Progress of a run on one mesh.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use gpu_smooth::{Phase, Progress};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use crate::terminal::Verbosity;
use crate::terminal::progress::form::{Form, PATIENCE};
use crate::terminal::progress::left::{Decay, Pace, duration_text};
use crate::terminal::progress::stage::Stage;
use crate::terminal::tell;

/// Interval between two drawings of a bar.
const FRAME: Duration = Duration::from_millis(200);

/// Display of a run's stages on standard error, for runs longer than [`PATIENCE`].
pub(crate) struct Display {
    shared: Arc<Shared>,
}

struct Shared {
    state: Mutex<State>,
    ended: Condvar,
}

struct State {
    has_ended: bool,
    form: Form,
    bar: ProgressBar,
    started: Instant,
    stage: Stage,
    stage_began: Instant,
    /// Stages after the sweeps that have not begun.
    later: Vec<Stage>,
    pace: Pace,
    decay: Decay,
    sweeps: Option<LatestSweep>,
    max_sweeps: u32,
    next_line: Instant,
}

/// The latest sweep of a run, with its times.
struct LatestSweep {
    progress: Progress,
    /// Start of the current phase of sweeps.
    began: Instant,
    reported_at: Instant,
}

impl LatestSweep {
    /// Returns the mean duration of a sweep in this phase, in seconds.
    fn seconds(&self) -> f64 {
        (self.reported_at - self.began).as_secs_f64() / f64::from(self.progress.sweep.max(1))
    }
}

impl Display {
    /// Makes a display for a run that ends within `tolerance` of the limit of f, or after `max_sweeps`.
    /// `tolerance` is `None` if the run has another goal.
    pub(crate) fn new(show: Verbosity, tolerance: Option<f64>, max_sweeps: u32) -> Self {
        let (form, now) = (Form::new(show), Instant::now());
        let wait = match form {
            Form::Lines(interval) if !show.verbose => interval,
            _ => PATIENCE,
        };
        let state = State {
            has_ended: false,
            form,
            bar: form.bar(),
            started: now,
            stage: Stage::Reading { bytes: 0 },
            stage_began: now,
            later: Vec::new(),
            pace: Pace::default(),
            decay: Decay::new(tolerance, max_sweeps),
            sweeps: None,
            max_sweeps,
            next_line: now + wait,
        };
        let shared = Arc::new(Shared { state: Mutex::new(state), ended: Condvar::new() });
        if form != Form::None {
            // A clock redraws the display, because reading, preparing and writing do not report their progress.
            let of_clock = Arc::clone(&shared);
            let clock = std::thread::Builder::new().name("progress".into());
            let _ = clock.spawn(move || of_clock.tick());
        }
        Self { shared }
    }

    /// Announces the stages after the sweeps, whose time counts as time left from the sweeps on.
    pub(crate) fn expect(&self, later: Vec<Stage>) {
        self.shared.lock().later = later;
    }

    /// Ends the current stage, whose duration is recorded, and begins `stage`.
    pub(crate) fn stage(&self, stage: Stage) {
        let mut state = self.shared.lock();
        let seconds = state.stage_began.elapsed().as_secs_f64();
        let ended = state.stage;
        state.pace.learn(ended, seconds);
        state.stage = stage;
        state.later.retain(|later| later.name() != stage.name());
        state.stage_began = Instant::now();
        if tell::is_json() && state.form != Form::None {
            tell::event(json!({ "event": "stage", "stage": stage.name() }));
        }
    }

    /// Records the progress of sweeps and updates the display.
    pub(crate) fn sweep(&self, progress: &Progress) {
        let mut state = self.shared.lock();
        let reported_at = Instant::now();
        let began = match &state.sweeps {
            Some(last) if last.progress.phase == progress.phase => last.began,
            Some(_) => reported_at,
            None => state.stage_began,
        };
        state.sweeps = Some(LatestSweep { progress: *progress, began, reported_at });
        if progress.phase == Phase::Smoothing {
            state.decay.learn(progress.sweep, progress.f);
        }
        state.show();
    }

    /// Hides the bar during a call of `print`.
    pub(crate) fn aside(&self, print: impl FnOnce()) {
        let state = self.shared.lock();
        state.bar.suspend(print);
    }

    /// Removes the bar and ends the display.
    pub(crate) fn clear(&self) {
        let mut state = self.shared.lock();
        state.has_ended = true;
        state.bar.finish_and_clear();
        self.shared.ended.notify_all();
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        self.clear();
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn tick(&self) {
        let mut state = self.lock();
        while !state.has_ended {
            state.show();
            let waited = self.ended.wait_timeout(state, FRAME);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

impl State {
    fn show(&mut self) {
        let now = Instant::now();
        if self.has_ended || now - self.started < PATIENCE {
            return;
        }
        match self.form {
            Form::None => {}
            Form::Lines(interval) => {
                if now >= self.next_line {
                    self.next_line = now + interval;
                    self.line();
                }
            }
            Form::Bar => {
                let (text, left) = (self.text(), self.left());
                let seconds = self.stage_began.elapsed().as_secs_f64();
                // A narrow terminal has no space for a bar beside the text.
                let template = match left {
                    Some(_) => "{bar:16} {wide_msg}",
                    None => "{wide_msg}",
                };
                if let Ok(style) = ProgressStyle::with_template(template) {
                    self.bar.set_style(style);
                }
                let share = left.map_or(0.0, |left| seconds / (seconds + left).max(1e-9));
                self.bar.set_position((1000.0 * share) as u64);
                self.bar.set_message(text);
            }
        }
    }

    fn line(&self) {
        if !tell::is_json() {
            return tell::note(false, &self.text());
        }
        let mut event = json!({
            "event": "progress", "stage": self.stage.name(),
            "stage_seconds": self.stage_began.elapsed().as_secs_f64(), "seconds_left": self.left(),
        });
        if let (Stage::Smoothing, Some(LatestSweep { progress, .. })) = (self.stage, &self.sweeps) {
            event["sweep"] = progress.sweep.into();
            event["f"] = progress.f.into();
            event["finds_optimum"] = (progress.phase == Phase::Reference).into();
        }
        tell::event(event);
    }

    /// Describes the current stage, its elapsed time and its estimated remaining time.
    fn text(&self) -> String {
        let mut text = match (self.stage, &self.sweeps) {
            (Stage::Smoothing, Some(swept)) => {
                let LatestSweep { progress: Progress { sweep, f, phase }, began, .. } = swept;
                let speed = match swept.seconds() {
                    seconds if seconds > 0.5 => format!("{seconds:.1} s/sweep"),
                    seconds => format!("{:.0} sweeps/s", 1.0 / seconds.max(1e-6)),
                };
                let figures =
                    format!("f {f:.7}  {speed}  {}", duration_text(began.elapsed().as_secs_f64()));
                match phase {
                    Phase::Reference => format!("finding the optimum: sweep {sweep}  {figures}"),
                    Phase::Improving => format!("improving the worst triangles: f {f:.7}"),
                    _ => format!("sweep {sweep}/{}  {figures}", self.max_sweeps),
                }
            }
            (stage, _) => {
                format!(
                    "{}  {}",
                    stage.text(),
                    duration_text(self.stage_began.elapsed().as_secs_f64())
                )
            }
        };
        if let Some(left) = self.left().filter(|left| *left > 0.5) {
            text += &format!(", about {} left", duration_text(left));
        }
        text
    }

    /// Estimates the remaining seconds. Before the sweeps, the estimate covers the current stage. From the sweeps on, the
    /// estimate covers the rest of the run. `None` for stages without an estimate, and for stages that have exceeded
    /// their estimate.
    fn left(&self) -> Option<f64> {
        let seconds = self.stage_began.elapsed().as_secs_f64();
        let of_stage = match (self.stage, &self.sweeps) {
            (Stage::Smoothing, Some(swept)) if swept.progress.phase == Phase::Smoothing => {
                let since = swept.reported_at.elapsed().as_secs_f64();
                self.decay.sweeps_left()? * swept.seconds() - since
            }
            (Stage::Smoothing, _) => return None,
            (stage, _) => self.pace.whole(stage)? - seconds,
        };
        let is_last_part =
            matches!(self.stage, Stage::Smoothing | Stage::Writing { .. } | Stage::Drawing { .. });
        let later = self.later.iter().filter(|_| is_last_part);
        let later: f64 = later.filter_map(|&stage| self.pace.whole(stage)).sum();
        (of_stage > 0.0).then_some(of_stage + later)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Makes a display of a run whose f has decayed within its tolerance, `since` before now.
    fn after_sweeps(since: Duration) -> Display {
        let display = Display::new(Verbosity { quiet: true, verbose: false }, Some(1e-6), 1000);
        display.stage(Stage::Smoothing);
        for sweep in [1, 5, 20] {
            let f = 1.0 + 0.8f64.powi(sweep as i32);
            display.sweep(&Progress { sweep, f, phase: Phase::Smoothing });
        }
        let mut state = display.shared.lock();
        if let Some(sweeps) = &mut state.sweeps {
            // Each of the 20 sweeps took 0.1 s, and 45 are left.
            sweeps.reported_at -= since;
            sweeps.began = sweeps.reported_at - Duration::from_secs(2);
        }
        drop(state);
        display
    }

    #[test]
    fn the_time_left_while_smoothing_includes_later_stages() {
        let display = after_sweeps(Duration::ZERO);
        let left = |display: &Display| display.shared.lock().left();
        let of_sweeps = left(&display).unwrap();
        assert!((of_sweeps - 4.5).abs() < 0.1, "{of_sweeps}");
        let drawing = Stage::Drawing { triangles: 1_000_000 };
        display.expect(vec![Stage::Writing { bytes: 900_000_000 }, drawing]);
        // Writing takes 2 s, and drawing 2 s.
        let all = left(&display).unwrap();
        assert!((all - of_sweeps - 4.0).abs() < 0.1, "{all}");
        display.stage(Stage::Writing { bytes: 900_000_000 });
        let all = left(&display).unwrap();
        assert!((all - 4.0).abs() < 0.1, "{all}");
        display.stage(drawing);
        let all = left(&display).unwrap();
        assert!((all - 2.0).abs() < 0.1, "{all}");
    }

    #[test]
    fn no_time_left_is_claimed_after_the_estimated_end_of_the_sweeps() {
        let display = after_sweeps(Duration::from_secs(10));
        display.expect(vec![Stage::Writing { bytes: 900_000_000 }]);
        assert_eq!(display.shared.lock().left(), None);
    }
}
