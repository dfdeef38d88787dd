//! The options of a run.

use crate::error::SmoothError;
use crate::layout::Problem;
use crate::metric::Metric;
use crate::metric::Scheme;
use crate::precision::Precision;
use crate::run::line_search::LONGEST;
use crate::run::plan::Plan;
use crate::run::step::{Derivatives, Sharpness};
use crate::run::stop::StopRule;
use crate::run::worst_by::WorstBy;

/// Whether sweeps are followed by corrections from coarser levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// [`Multilevel`](Self::Multilevel) if the options and the device allow it, else [`Sweeps`](Self::Sweeps).
    #[default]
    Auto,
    /// Sweeps alone at first; once they gain little, each sweep is followed by a correction from coarser levels. About
    /// 15 sweeps bring f within 1e-6 of its limit, for meshes of any size. If metrics alternate, they do so in the
    /// sweeps alone. Sweeps with corrections are by the base metric, so that the run ends at its optimum.
    ///
    /// Requires a base metric that [is corrected](crate::Properties::is_corrected) (all but area), analytic
    /// derivatives, one Newton step per visit, and [`Options::omega`] left at `None`.
    ///
    /// `Sweeps` that an application encodes with this method are corrected from the first sweep on.
    /// With [`Auto`](Self::Auto) they are not corrected, and edge and alternating metrics cannot be corrected there.
    Multilevel,
    /// Sweeps alone, over-relaxed by [`Options::omega`].
    Sweeps,
}

/// A limit on how bad a step may make a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Guard {
    /// With a metric that has a barrier, no limit but the objective. With other metrics, a step may leave no triangle
    /// with an inverse mean ratio larger than that of the worst triangle with a free vertex before the run, nor larger
    /// than 30, unless the patch already had a worse one.
    #[default]
    ByMetric,
    /// With any metric, a step may leave no triangle worse than the worst triangle with a free vertex before the run,
    /// by the inverse mean ratio after target maps are applied. So the worst element of a run never gets worse. Only
    /// for whole runs: `Sweeps`, which an application encodes itself, refuse it.
    Worst,
}

/// The options of a run. [`Options::default`] smooths by IMR with corrections from coarser levels, until an estimated
/// 1e-6 of f is left to gain.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The metric, or several metrics in turn. The first one judges convergence.
    pub scheme: Scheme,
    /// Whether sweeps are corrected from coarser levels.
    pub method: Method,
    /// The most sweeps of the run.
    pub max_sweeps: u32,
    /// The run ends when the estimated distance of f to its limit, relative to f, is below this. The
    /// estimate extrapolates the decay over the last 16 or more sweeps (over the last two where each is corrected
    /// from coarser levels), so it bounds what remains, not the change in one sweep. By EDGE it is that of a p-norm: with the largest exponent f ends
    /// some 2e-5 above a minimum of its own, however small the tolerance. 0 turns this test off.
    pub tolerance: f64,
    /// The precision in which the result will be stored. The result is rounded to it before it is checked: as stored,
    /// it has no inverted triangle and a lower f. Fixed vertices are rounded as well, if the mesh is not in that
    /// precision.
    pub stored: Precision,
    /// Ends the run at a share of the way to a desired objective; the tolerance then has no effect. `None` for no goal.
    pub goal: Option<Goal>,
    /// Over-relaxation, between 0 and 2: the factor by which each Newton step is multiplied in its first trial. 1 is
    /// the published method.
    ///
    /// `None` takes [`Properties::omega`](crate::Properties::omega) in a scheme of one metric and 1 in a scheme that
    /// alternates. With alternating metrics each would have to undo the overshoot of the one before, and the run ends
    /// worse (edge+imr on a 2,000-vertex mesh at 1.536 instead of 1.492). Runs with corrections use values of their
    /// own.
    pub omega: Option<f64>,
    /// Number of sweeps before over-relaxation starts, in runs without corrections.
    pub plain_sweeps: u32,
    /// The most Newton steps per visit of a vertex, from 1 to 1000. With analytic derivatives a visit ends earlier once
    /// its steps have become short.
    pub inner: u32,
    /// A limit on how bad a step may make a triangle. No step ever inverts one.
    pub guard: Guard,
    /// The largest distance of a vertex from its position before the run, divided by the mean length of the edges there
    /// before. Above 0; `None` for no bound. Only for whole runs, by one metric other than edge.
    pub max_move: Option<f64>,
    /// Whether every triangle must keep an altitude of at least the least altitude in the mesh, which bounds the time
    /// step of explicit solvers. Only for whole runs, by one metric other than edge.
    pub keep_altitude: bool,
    /// The measure by which the worst triangles are improved after the last sweep, on the CPU; `None` to leave them as
    /// they are. Free vertices around the worst thousandth of the triangles (10 to 1000 of them) move so that the worst
    /// triangle around them becomes less bad, and none becomes worse than that was. f may rise a little; where the worst
    /// triangle of the mesh becomes no better, nothing moves. Only for whole runs, and not after one that was canceled.
    pub improve_worst: Option<WorstBy>,
    /// How metrics are differentiated.
    pub derivatives: Derivatives,
    /// The exponent of the p-norm that replaces EDGE in Newton's method. `None` takes [`Sharpness::CORRECTED`], as far as the tolerance
    /// asks, in runs with corrections and [`Sharpness::FIXED`] in runs of sweeps alone.
    pub sharpness: Option<Sharpness>,
    /// Whether the history holds the objective of every metric, not of the base metric alone.
    pub track_all: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            scheme: Metric::Imr.into(),
            method: Method::Auto,
            max_sweeps: 1000,
            tolerance: 1e-6,
            stored: Precision::Double,
            goal: None,
            omega: None,
            plain_sweeps: 4,
            inner: 1,
            guard: Guard::ByMetric,
            max_move: None,
            keep_altitude: false,
            improve_worst: None,
            derivatives: Derivatives::Analytic,
            sharpness: None,
            track_all: false,
        }
    }
}

impl Options {
    /// The largest value of [`inner`](Self::inner). It is limited because the [`Observer`](crate::Observer) cannot end
    /// a sweep.
    pub const MOST_INNER: u32 = 1000;

    /// Returns the options of the method of Park & Shontz (2011): sweeps alone, one Newton step per visit, no
    /// over-relaxation.
    pub fn paper(scheme: Scheme) -> Self {
        Self { scheme, method: Method::Sweeps, omega: Some(1.0), ..Self::default() }
    }

    /// Whether runs with these options are corrected from coarser levels, if the device has room for the levels.
    pub fn is_multilevel(&self) -> bool {
        self.method != Method::Sweeps && self.only_sweeps().is_none()
    }

    /// Returns the reason why these options rule out corrections, if they do.
    fn only_sweeps(&self) -> Option<&'static str> {
        let metric = self.scheme.base();
        if !metric.properties().is_corrected {
            Some(
                "runs by this metric are not corrected from coarser levels: take another metric, such as imr",
            )
        } else if self.omega.is_some() {
            Some("corrected runs choose the over-relaxation themselves: do not set omega")
        } else if self.derivatives != Derivatives::Analytic {
            Some("corrections from coarser levels need analytic derivatives")
        } else if self.inner != 1 {
            Some("corrections from coarser levels need one Newton step per visit: set inner to 1")
        } else {
            None
        }
    }

    /// Checks every field against its range, and against whether the mesh has targets.
    pub(crate) fn check_for(&self, problem: &Problem) -> Result<(), SmoothError> {
        self.check()?;
        if problem.targets().is_some() && self.derivatives != Derivatives::Analytic {
            let (option, value) = ("derivatives", "finite differences".to_owned());
            return Err(SmoothError::Option {
                option,
                value,
                remedy: "a mesh with targets needs analytic derivatives",
            });
        }
        Ok(())
    }

    /// Checks every field against its range.
    pub(crate) fn check(&self) -> Result<(), SmoothError> {
        let refuse = |option, value: f64, remedy| {
            Err(SmoothError::Option { option, value: value.to_string(), remedy })
        };
        if !(self.tolerance >= 0.0 && self.tolerance.is_finite()) {
            return refuse("tolerance", self.tolerance, "it must be 0 or above");
        }
        if let Some(omega) = self.omega.filter(|omega| !(*omega > 0.0 && *omega < 2.0)) {
            return refuse("omega", omega, "over-relaxation must be above 0 and below 2");
        }
        if let Some(most) = self.max_move.filter(|most| !(*most > 0.0 && most.is_finite())) {
            return refuse("max move", most, "it must be above 0");
        }
        if !(1..=Self::MOST_INNER).contains(&self.inner) {
            return refuse("inner", self.inner.into(), "a visit takes from 1 to 1000 Newton steps");
        }
        if let Some(Sharpness { first, last, .. }) = self.sharpness {
            let (first, most) = (f64::from(first), f64::from(first.max(last)));
            if most > f64::from(Sharpness::MOST) {
                return refuse(
                    "sharpness",
                    most,
                    "first and last are log2 of the exponent, and may be 13 at most",
                );
            }
            if first > f64::from(last) {
                let remedy = "first may not be above last, as the exponent only grows";
                return refuse("sharpness", first, remedy);
            }
        }
        if self.scheme.period() > Scheme::LONGEST {
            let period = f64::from(self.scheme.period());
            return refuse("scheme length", period, "a scheme can have 60 metrics at most");
        }
        if let (Method::Multilevel, Some(reason)) = (self.method, self.only_sweeps()) {
            let value = "multilevel".to_owned();
            return Err(SmoothError::Option { option: "method", value, remedy: reason });
        }
        match self.goal {
            Some(Goal { fraction, .. }) if !(fraction > 0.0 && fraction <= 1.0) => {
                refuse("fraction", fraction, "it must be above 0 and at most 1")
            }
            Some(Goal { desired: Desired::Value(desired), .. }) if !desired.is_finite() => {
                refuse("desired", desired, "it must be a finite number")
            }
            _ => Ok(()),
        }
    }

    /// Returns the plan of sweeps with these options, for code that drives sweeps itself. Ignores [`goal`](Self::goal)
    /// and [`method`](Self::method).
    pub fn plan(&self) -> Plan {
        self.plan_with(None, self.sharpness.unwrap_or(Sharpness::FIXED))
    }

    /// Returns the plan of a run with these options, which ends when the base objective is below `target`, if one is
    /// given.
    pub(crate) fn plan_to(&self, target: Option<f64>) -> Plan {
        // Sweeps by EDGE that another metric judges are few, and by no p-norm that grows.
        let is_corrected_edge = self.is_multilevel() && !self.scheme.base().is_smooth();
        let usual = match (is_corrected_edge, target) {
            (true, Some(_)) => Sharpness::CORRECTED,
            (true, None) => Sharpness::corrected_to(self.tolerance),
            (false, _) => Sharpness::FIXED,
        };
        let plan = self.plan_with(target, self.sharpness.unwrap_or(usual));
        Plan { is_guard_penalized: is_corrected_edge, ..plan }
    }

    fn plan_with(&self, target: Option<f64>, sharpness: Sharpness) -> Plan {
        let own =
            |metric: Metric| if self.scheme.alternates() { 1.0 } else { metric.properties().omega };
        let mut by_metric = [1.0; Metric::ALL.len()];
        for (slot, metric) in by_metric.iter_mut().zip(Metric::ALL) {
            *slot = self.omega.unwrap_or(own(*metric));
        }
        Plan {
            scheme: self.scheme.clone(),
            omega: by_metric,
            plain_sweeps: self.plain_sweeps,
            inner: self.inner.max(1),
            derivatives: [self.derivatives; Metric::ALL.len()],
            sharpness,
            stop: StopRule {
                target,
                tolerance: if target.is_some() { 0.0 } else { self.tolerance },
                max_sweeps: self.max_sweeps,
            },
            track_all: self.track_all,
            shape_guard: f64::INFINITY,
            worst_guard: f64::INFINITY,
            longest: if self.is_multilevel() { LONGEST } else { 1.0 },
            is_guard_penalized: false,
        }
    }
}

/// The convergence test of Park & Shontz, equation (2): the run ends when
/// f_initial - f > fraction · (f_initial - f_desired), with f the objective by the base metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// The share of the way from f_initial to f_desired, above 0 and at most 1. The paper's is 0.95.
    pub fraction: f64,
    /// The objective f_desired.
    pub desired: Desired,
}

/// The objective f_desired of a [`Goal`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Desired {
    /// This value of the objective by the base metric.
    Value(f64),
    /// The converged optimum of the base metric, found by runs before the smoothing. If the base metric is IMR or AR,
    /// that is one run. For other metrics it is the better of two runs: one by the base metric alone, and one by the
    /// base metric after IMR. They use over-relaxation, or corrections from coarser levels if the metric has them.
    Auto,
}
