//! The line search along a correction.

/// Largest number of lengths that are tried along one correction.
const TRIALS: u32 = 8;
/// Share of the predicted decrease that a trial must reach (Armijo).
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Largest relative distance of the first trial from the minimum of the fitted parabola, at which the trial is accepted
/// at once.
pub(crate) const CLOSE: f64 = 0.2;

/// Smallest and largest length of the first trial along a correction by a smooth metric. A single nearly flat triangle
/// may have made the last accepted length shorter.
pub(crate) const MIN_FIRST_LENGTH: f64 = 0.6;
pub(crate) const MAX_FIRST_LENGTH: f64 = 3.0;

/// A line search that proposes lengths, at which the caller evaluates the objective.
pub(crate) struct Search {
    here: f64,
    slope: f64,
    trials: u32,
    best: Option<(f64, f64)>,
}

impl Search {
    /// Returns the length of the first trial, from the last accepted length and the smallest first length.
    pub(crate) fn first_length(last_taken: f64, least: f64) -> f64 {
        last_taken.clamp(least, MAX_FIRST_LENGTH)
    }

    /// Starts a search from the objective `here`, with the negative derivative `slope`.
    pub(crate) fn new(here: f64, slope: f64) -> Self {
        Self { here, slope, trials: 0, best: None }
    }

    /// Records the objective at a length, or `None` if a triangle is inverted or breaks the shape guard there. Returns
    /// the next length to try, and `None` at the end of the search.
    pub(crate) fn tried(&mut self, length: f64, objective: Option<f64>) -> Option<f64> {
        self.trials += 1;
        let next = match objective {
            None if self.best.is_some() => return None,
            None => 0.5 * length,
            Some(there) => {
                let enough = there <= self.here + SUFFICIENT_DECREASE * length * self.slope;
                if enough && self.best.is_none_or(|(_, best)| there < best) {
                    self.best = Some((length, there));
                }
                let bend = there - self.here - self.slope * length;
                let minimum = match bend > 0.0 {
                    true => -self.slope * length * length / (2.0 * bend),
                    false => f64::INFINITY,
                };
                if enough && (self.trials > 1 || (minimum / length - 1.0).abs() <= CLOSE) {
                    return None;
                }
                minimum.clamp(0.1 * length, 3.0 * length)
            }
        };
        (self.trials < TRIALS).then_some(next)
    }

    /// Returns the best length with its objective. `None` if no trial lowered the objective enough.
    pub(crate) fn best(&self) -> Option<(f64, f64)> {
        self.best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Searches along a function. Returns the accepted length and the number of evaluations.
    fn search(f: impl Fn(f64) -> Option<f64>, slope: f64, first: f64) -> (Option<f64>, u32) {
        let mut search = Search::new(f(0.0).unwrap(), slope);
        let mut next = Some(first);
        while let Some(length) = next {
            next = search.tried(length, f(length));
        }
        (search.best().map(|(length, _)| length), search.trials)
    }

    #[test]
    fn a_parabola_takes_two_trials_or_one() {
        let f = |t: f64| Some((t - 1.5) * (t - 1.5));
        assert_eq!(search(f, -3.0, 1.0), (Some(1.5), 2));
        assert_eq!(search(f, -3.0, 1.4), (Some(1.4), 1));
    }

    #[test]
    fn an_inverted_triangle_shortens_the_step() {
        let f = |t: f64| (t < 0.3).then_some(-t);
        assert_eq!(search(f, -1.0, 1.0).0, Some(0.25));
    }

    #[test]
    fn no_descent_takes_no_step() {
        let (taken, trials) = search(|t| Some(t * t + t), -1.0, 1.0);
        assert_eq!((taken, trials), (None, TRIALS));
        assert_eq!(search(|t| (t == 0.0).then_some(1.0), -1.0, 1.0), (None, TRIALS));
    }
}
