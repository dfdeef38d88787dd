//! The line search along a Newton step of all vertices.

/// Share of the predicted decrease that a trial must reach (Armijo).
const SUFFICIENT_DECREASE: f64 = 1e-4;

/// A line search that begins with the whole step and only shortens it.
pub(crate) struct StepSearch {
    here: f64,
    /// Decrease of the objective at length 1 by its slope.
    descent: f64,
    next: Option<f64>,
    trials: u32,
    best: (f64, f64),
    is_broken: bool,
}

impl StepSearch {
    /// Largest number of lengths that are tried along one step.
    pub(crate) const TRIALS: u32 = 10;

    /// Begins a search from the objective `here`. `descent` is the negative of its derivative along the step;
    /// without a positive one, no length is tried.
    pub(crate) fn new(here: f64, descent: f64) -> Self {
        let next = (descent > 0.0).then_some(1.0);
        Self { here, descent, next, trials: 0, best: (0.0, here), is_broken: false }
    }

    /// Returns the next length to try. `None` at the end of the search.
    pub(crate) fn next(&self) -> Option<f64> {
        self.next
    }

    /// Records the objective at a length, `None` if a triangle is inverted or breaks the shape guard there.
    pub(crate) fn tried(&mut self, length: f64, objective: Option<f64>) {
        self.trials += 1;
        let shorter = match objective {
            Some(there) if there <= self.here - SUFFICIENT_DECREASE * length * self.descent => {
                self.best = (length, there);
                self.next = None;
                return;
            }
            Some(there) => {
                let bend = there - self.here + self.descent * length;
                let minimum = 0.5 * self.descent * length * length / bend;
                minimum.clamp(0.1 * length, 0.5 * length)
            }
            None => {
                self.is_broken = true;
                0.5 * length
            }
        };
        self.next = Some(shorter).filter(|next| self.trials < Self::TRIALS && next.is_finite());
    }

    /// Returns whether a tried length inverted a triangle or broke the shape guard.
    pub(crate) fn is_broken(&self) -> bool {
        self.is_broken
    }

    /// Returns the accepted length with its objective; 0 and the objective before if no length was accepted.
    pub(crate) fn best(&self) -> (f64, f64) {
        self.best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search(f: impl Fn(f64) -> Option<f64>, descent: f64) -> (f64, u32) {
        let mut search = StepSearch::new(f(0.0).unwrap(), descent);
        while let Some(length) = search.next() {
            search.tried(length, f(length));
        }
        (search.best().0, search.trials)
    }

    #[test]
    fn a_step_is_only_shortened() {
        assert_eq!(search(|t| Some((t - 1.5) * (t - 1.5)), 3.0), (1.0, 1));
        // The minimum of the parabola is at 0.2.
        let (length, trials) = search(|t| Some((t - 0.2) * (t - 0.2)), 0.4);
        assert!((length - 0.2).abs() < 1e-12 && trials == 2);
        assert_eq!(search(|t| (t < 0.3).then_some(-t), 1.0), (0.25, 3));
        assert_eq!(search(Some, 1.0), (0.0, StepSearch::TRIALS));
        assert_eq!(search(|t| (t == 0.0).then_some(1.0), 1.0), (0.0, StepSearch::TRIALS));
        assert_eq!(search(|_| Some(1.0), f64::NAN), (0.0, 0));
    }
}
