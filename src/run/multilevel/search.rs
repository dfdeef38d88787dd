//! How far to go along a correction.

/// Lengths that may be tried along one correction.
const TRIALS: u32 = 8;
/// Share of the predicted decrease that must be had (Armijo).
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// How far from the length tried a parabola's minimum may lie for that length to be good enough.
const CLOSE: f64 = 0.2;

/// A line search on the objective, which only proposes lengths: whoever can evaluate the objective
/// tries them.
pub(crate) struct Search {
    here: f64,
    slope: f64,
    trials: u32,
    best: Option<(f64, f64)>,
}

impl Search {
    /// The first length to try, given the last one taken. One nearly flat triangle can have held that
    /// one down, so it is let back up at once.
    pub(crate) fn first_length(last_taken: f64) -> f64 {
        last_taken.clamp(0.6, 3.0)
    }

    /// Searches from an objective of `here` with the derivative `slope`, below zero.
    pub(crate) fn new(here: f64, slope: f64) -> Self {
        Self { here, slope, trials: 0, best: None }
    }

    /// Takes in the objective at a length, `None` if a triangle is inverted there, and returns the length
    /// to try next, if any.
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

    /// The length to take and the objective there; `None` if none lowers it.
    pub(crate) fn best(&self) -> Option<(f64, f64)> {
        self.best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Searches along a function and returns the length taken and the evaluations it took.
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
