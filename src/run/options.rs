//! What a caller can ask for.

use crate::error::SmoothError;
use crate::metric::Metric;
use crate::metric::Scheme;
use crate::run::plan::Plan;
use crate::run::step::{Derivatives, Sharpness};
use crate::run::stop::StopRule;

/// How a run goes from sweep to sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// [`Multilevel`](Self::Multilevel) where it is to be had, else [`Sweeps`](Self::Sweeps).
    #[default]
    Auto,
    /// Sweeps, each followed, once sweeps alone gain little, by a correction from coarser levels:
    /// some 15 sweeps bring f within 1e-6 of its limit, whatever the size of the mesh. For a
    /// scheme of one metric that has a [`Stiffness`](crate::Stiffness) (imr, ar, rms), with exact derivatives, one
    /// Newton step a visit and `omega` left open.
    Multilevel,
    /// Sweeps alone, over-relaxed as [`Options::omega`] says.
    Sweeps,
}

/// How to smooth. [`Options::default`] is IMR with over-relaxation until little is left to gain.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The metric, or the metrics in turn. The first judges convergence.
    pub scheme: Scheme,
    /// Sweeps alone, or corrected from coarser levels.
    pub method: Method,
    /// The run ends after this many sweeps at the latest.
    pub max_sweeps: u32,
    /// The run ends when the estimated distance to its limit, relative to f, is below this. The
    /// estimate extrapolates the decay over the last 16 or more sweeps, so it speaks of what
    /// remains, not of the change in one sweep. 0 never ends a run.
    pub tolerance: f64,
    /// Ends the run at a share of the way to a desired objective; the tolerance then does not.
    pub goal: Option<Goal>,
    /// Over-relaxation: each Newton step is first tried at this multiple. `None` takes the metric's
    /// own in a scheme of one metric, and 1 in one that alternates: there the overshoot of one
    /// metric's sweep is what the next has to mend, and the run ends worse (edge+imr on a
    /// 2,000-vertex mesh at 1.536 instead of 1.492). 1 is the published method.
    pub omega: Option<f64>,
    /// Sweeps before over-relaxation starts.
    pub plain_sweeps: u32,
    /// The most Newton steps per visit of a vertex. With analytic derivatives a visit ends sooner once
    /// its steps have become short.
    pub inner: u32,
    /// How metrics are differentiated.
    pub derivatives: Derivatives,
    /// The exponent of the p-norm that stands in for EDGE in Newton's method.
    pub sharpness: Sharpness,
    /// Whether the history holds the objective of every metric.
    pub track_all: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            scheme: Metric::Imr.into(),
            method: Method::Auto,
            max_sweeps: 1000,
            tolerance: 1e-6,
            goal: None,
            omega: None,
            plain_sweeps: 4,
            inner: 1,
            derivatives: Derivatives::Analytic,
            sharpness: Sharpness::FIXED,
            track_all: false,
        }
    }
}

impl Options {
    /// The method as published: one plain Newton step, no over-relaxation.
    pub fn paper(scheme: Scheme) -> Self {
        Self { scheme, method: Method::Sweeps, omega: Some(1.0), ..Self::default() }
    }

    /// Whether the run is corrected from coarser levels.
    pub fn is_multilevel(&self) -> bool {
        self.method != Method::Sweeps && self.only_sweeps().is_none()
    }

    /// Why there are no corrections for these options, if there are none.
    fn only_sweeps(&self) -> Option<&'static str> {
        let metric = self.scheme.base();
        if self.scheme.period() > 1 {
            Some("metrics that alternate have no correction: give one metric")
        } else if metric.properties().stiffness.is_none() {
            Some("this metric has no correction: take imr, ar or rms")
        } else if self.omega.is_some() {
            Some("over-relaxation is its own: leave omega open")
        } else if self.derivatives != Derivatives::Analytic {
            Some("it needs exact derivatives")
        } else if self.inner != 1 {
            Some("it takes one Newton step a visit")
        } else {
            None
        }
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
        if self.inner == 0 {
            return refuse("inner", 0.0, "a visit takes at least one Newton step");
        }
        if self.sharpness.first.max(self.sharpness.last) > Sharpness::MOST {
            let most = f64::from(self.sharpness.first.max(self.sharpness.last));
            return refuse("sharpness", most, "log2 k can be 10 at most");
        }
        if self.sharpness.first > self.sharpness.last {
            let first = f64::from(self.sharpness.first);
            return refuse(
                "sharpness",
                first,
                "the exponent grows: the first may not be above the last",
            );
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

    /// What the engines are to do by these options, for those who drive sweeps themselves. Of
    /// [`goal`](Self::goal) and [`method`](Self::method) nothing is taken over: the one needs a run before, the other levels.
    pub fn plan(&self) -> Plan {
        self.plan_to(None)
    }

    /// What the engines are to do by these options, the run ending below `target` if there is one.
    pub(crate) fn plan_to(&self, target: Option<f64>) -> Plan {
        let alternates = self.scheme.metrics().iter().any(|&m| m != self.scheme.base());
        let own = |metric: Metric| if alternates { 1.0 } else { metric.properties().omega };
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
            sharpness: self.sharpness,
            stop: StopRule {
                target,
                tolerance: if target.is_some() { 0.0 } else { self.tolerance },
                max_sweeps: self.max_sweeps,
            },
            track_all: self.track_all,
            shape_guard: f64::INFINITY,
        }
    }
}

/// The convergence test of Park & Shontz, equation (2): the run is done when
/// f_initial - f > fraction · (f_initial - f_desired), f by the base metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// The share of the way to go; the paper's is 0.95.
    pub fraction: f64,
    /// Where the way leads.
    pub desired: Desired,
}

/// The objective a [`Goal`] is measured by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Desired {
    /// This value.
    Value(f64),
    /// The fully converged optimum of the base metric, which is found first: the better of the base
    /// metric alone and of the base metric after IMR, both over-relaxed.
    Auto,
}
