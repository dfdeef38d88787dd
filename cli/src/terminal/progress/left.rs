//! Estimates of the remaining time.

use crate::terminal::progress::stage::Stage;

/// Bytes of text per second that two cores read, and write (`docs/performance.md`).
const READ: f64 = 400e6;
const WRITE: f64 = 450e6;
/// Vertices per second that two cores prepare.
const PREPARE: f64 = 4e6;
/// Triangles per second that are drawn before and after a run.
const DRAW: f64 = 0.5e6;

/// Estimator of the duration of stages. The relative speed of the machine is learned from earlier stages.
#[derive(Default)]
pub(crate) struct Pace {
    /// Expected and actual seconds of the earlier stages.
    expected: f64,
    took: f64,
}

impl Pace {
    /// Records the duration of a stage.
    pub(crate) fn learn(&mut self, stage: Stage, seconds: f64) {
        if let Some(expected) = usual(stage) {
            self.expected += expected;
            self.took += seconds;
        }
    }

    /// Estimates the duration of a whole stage in seconds. `None` for untangling and sweeps, and for files or meshes
    /// of unknown size.
    pub(crate) fn whole(&self, stage: Stage) -> Option<f64> {
        // Durations below 0.2 s say little about the speed of the machine.
        let slower = if self.took > 0.2 { self.took / self.expected } else { 1.0 };
        usual(stage).map(|seconds| seconds * slower)
    }
}

/// Returns the duration of a stage, in seconds, on the machine of the measurements. `None` as for [`Pace::whole`].
fn usual(stage: Stage) -> Option<f64> {
    let seconds = match stage {
        Stage::Reading { bytes } => bytes as f64 / READ,
        Stage::Preparing { vertices } => vertices as f64 / PREPARE,
        Stage::Writing { bytes } => bytes as f64 / WRITE,
        Stage::Drawing { triangles } => triangles as f64 / DRAW,
        Stage::Untangling | Stage::Smoothing => return None,
    };
    (seconds > 0.0).then_some(seconds)
}

/// Estimator of the number of remaining sweeps.
pub(crate) struct Decay {
    /// The fraction of f that may remain to be gained; `None` if the run has another goal.
    tolerance: Option<f64>,
    max_sweeps: u32,
    /// The last three recorded sweeps, each with f after the sweep.
    known: Vec<(u32, f64)>,
}

impl Decay {
    pub(crate) fn new(tolerance: Option<f64>, max_sweeps: u32) -> Self {
        Self { tolerance, max_sweeps, known: Vec::new() }
    }

    /// Records f after a sweep. If the sweep's number does not exceed the last recorded number, a new series starts.
    pub(crate) fn learn(&mut self, sweep: u32, f: f64) {
        if self.known.last().is_some_and(|last| last.0 >= sweep) {
            self.known.clear();
        }
        if self.known.len() == 3 {
            self.known.remove(0);
        }
        self.known.push((sweep, f));
    }

    /// Estimates the number of remaining sweeps: until geometrically decaying gains are within the tolerance, at most
    /// until `max_sweeps`. `None` without a tolerance or before three records, and if f does not decay, unless the
    /// tolerance is 0.
    pub(crate) fn sweeps_left(&self) -> Option<f64> {
        let &(last, f) = self.known.last()?;
        let most = f64::from(self.max_sweeps.saturating_sub(last));
        let tolerance = self.tolerance?;
        let [(a, fa), (b, fb), (c, fc)] = self.known[..] else { return None };
        let [a, b, c] = [a, b, c].map(f64::from);
        let (before, now) = (fa - fb, fb - fc);
        let Some(decay) = decay(before / now, b - a, c - b).filter(|_| now > 0.0) else {
            return Some(most).filter(|_| tolerance == 0.0);
        };
        // The remaining gain, doubled as in the stop rule.
        let remaining = 2.0 * now / (decay * (c - b)).exp_m1();
        let sweeps = (remaining / (tolerance * f).max(f64::MIN_POSITIVE)).ln() / decay;
        Some(sweeps.clamp(0.0, most))
    }
}

/// Returns the rate λ at which the distance from the limit falls as exp(−λ) per sweep. `ratio` is the gain of
/// `before` sweeps divided by that of the next `after` sweeps. `None` if the distance does not fall.
fn decay(ratio: f64, before: f64, after: f64) -> Option<f64> {
    let of = |decay: f64| (decay * before).exp_m1() / -(-decay * after).exp_m1();
    let (mut low, mut high) = (1e-9, 40.0);
    if !(ratio.is_finite() && ratio > of(low)) {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if of(middle) < ratio { low = middle } else { high = middle }
    }
    Some(high)
}

/// Formats a duration as seconds, minutes and seconds, or hours and minutes.
pub(crate) fn duration_text(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..100 => format!("{whole} s"),
        100..6000 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_geometric_decay_is_foreseen() {
        let f = |sweep: u32| 1.0 + 0.8f64.powi(sweep as i32);
        let mut decay = Decay::new(Some(1e-6), 1000);
        for sweep in [1, 5, 20] {
            assert_eq!(decay.sweeps_left(), None);
            decay.learn(sweep, f(sweep));
        }
        // 2 · 0.8ⁿ is 1e-6 after 65.02 sweeps.
        let left = decay.sweeps_left().unwrap();
        assert!((left - 45.0).abs() < 0.1, "{left}");
        decay.learn(40, f(40));
        let left = decay.sweeps_left().unwrap();
        assert!((left - 25.0).abs() < 0.1, "{left}");
    }

    #[test]
    fn no_end_is_foreseen_where_there_is_none() {
        let mut decay = Decay::new(Some(1e-6), 100);
        [(1, 3.0), (2, 2.9), (3, 2.7)].into_iter().for_each(|(sweep, f)| decay.learn(sweep, f));
        assert_eq!(decay.sweeps_left(), None);
        let mut all = Decay::new(Some(0.0), 100);
        [(1, 3.0), (2, 2.9), (10, 2.9)].into_iter().for_each(|(sweep, f)| all.learn(sweep, f));
        assert_eq!(all.sweeps_left(), Some(90.0));
        let mut goal = Decay::new(None, 100);
        [(1, 3.0), (2, 2.5), (3, 2.3)].into_iter().for_each(|(sweep, f)| goal.learn(sweep, f));
        assert_eq!(goal.sweeps_left(), None);
    }

    #[test]
    fn a_slow_machine_is_known_from_its_first_stage() {
        let mut pace = Pace::default();
        let (read, write) =
            (Stage::Reading { bytes: 800_000_000 }, Stage::Writing { bytes: 900_000_000 });
        assert_eq!((pace.whole(read), pace.whole(Stage::Smoothing)), (Some(2.0), None));
        pace.learn(read, 8.0);
        assert_eq!(pace.whole(write), Some(8.0));
        assert_eq!(pace.whole(Stage::Reading { bytes: 0 }), None);
    }

    #[test]
    fn times_are_printed_in_units_of_their_size() {
        let cases = [(0.4, "0 s"), (99.0, "99 s"), (150.0, "2 min 30 s"), (9000.0, "2 h 30 min")];
        for (seconds, text) in cases {
            assert_eq!(duration_text(seconds), text);
        }
    }
}
