//! Objectives over all triangles, from objectives over the triangles that a run is judged by.

use crate::cpu::mean_excess_left_out;
use crate::layout::Problem;
use crate::metric::Metric;
use crate::run::Objectives;

/// The constant part of the objective over all triangles: the mean over the triangles that no vertex of a run can change.
/// Reports state the objective over all triangles (Park & Shontz, equation 1).
pub(super) struct OverAll<'p> {
    /// The problem of the run, judged by the triangles that can move.
    pub(super) problem: &'p Problem,
    /// Share of the triangles by which the run is judged, from 0 exclusive to 1 inclusive.
    share: f64,
    /// Sum of q² over the other triangles by each metric, divided by the number of all triangles.
    constant: Objectives,
}

impl<'p> OverAll<'p> {
    /// Measures the triangles that are left out of the objective of `problem`, by each of `metrics`.
    pub(super) async fn new(problem: &'p Problem, metrics: &[Metric]) -> Self {
        let (judged, all) = (problem.judged_count(), problem.corners().element_count());
        let share = judged as f64 / all as f64;
        let mut constant = Objectives::empty();
        if judged < all {
            for &metric in metrics {
                let excess = mean_excess_left_out(metric, problem, problem.positions()).await;
                constant.set(metric, (1.0 - share) * (metric.ideal_squared() + excess));
            }
        }
        Self { problem, share, constant }
    }

    /// Returns the objective by `metric` over all triangles, given that over the judged triangles.
    pub(super) fn f(&self, metric: Metric, judged: f64) -> f64 {
        match self.constant.of(metric) {
            Some(constant) => self.share * judged + constant,
            None => judged,
        }
    }

    /// Returns the objective by `metric` over the judged triangles, given that over all triangles. The inverse of
    /// [`Self::f`].
    pub(super) fn judged(&self, metric: Metric, f: f64) -> f64 {
        self.constant.of(metric).map_or(f, |constant| (f - constant) / self.share)
    }

    /// Returns the objectives over all triangles, given those over the judged triangles.
    pub(super) fn objectives(&self, judged: Objectives) -> Objectives {
        let mut all = Objectives::empty();
        for &metric in Metric::ALL {
            if let Some(f) = judged.of(metric) {
                all.set(metric, self.f(metric, f));
            }
        }
        all
    }
}
