//! The meaning of the options of a run.

use std::path::PathBuf;

use gpu_smooth::{
    Derivatives, Desired, Goal, Guard, Method, Metric, Options, Precision, Scheme, Sharpness,
    WorstBy,
};

use crate::args::{
    DerivativesChoice, EdgeNorm, GuardChoice, History, MethodChoice, SmoothArgs, WorstArgs,
    WorstChoice,
};

impl SmoothArgs {
    /// Returns the meshes for `--out-dir`.
    pub(crate) fn meshes(&self) -> impl Iterator<Item = &PathBuf> {
        self.input.iter().chain(&self.output).chain(&self.more)
    }

    /// Returns the scheme: the metrics of the sweeps.
    pub(crate) fn scheme(&self) -> Scheme {
        self.scheme.clone().unwrap_or_else(|| self.target.default_metric().into())
    }

    /// Returns the share of f within which the run ends, if it has no other goal.
    pub(crate) fn estimated_end(&self) -> Option<f64> {
        let has_goal = self.fraction.is_some() || self.desired.is_some();
        (!has_goal).then_some(self.tolerance)
    }

    /// Returns the options of a run on a mesh whose file stores coordinates with precision `stored`.
    pub(crate) fn options(&self, stored: Precision) -> Options {
        let has_goal = self.fraction.is_some() || self.desired.is_some();
        let options = Options {
            scheme: self.scheme(),
            max_sweeps: self.max_sweeps,
            tolerance: self.tolerance,
            stored,
            goal: has_goal.then(|| Goal {
                fraction: self.fraction.unwrap_or(0.95),
                desired: self.desired.unwrap_or(Desired::Auto),
            }),
            method: match self.method {
                MethodChoice::Auto => Method::Auto,
                MethodChoice::Multilevel => Method::Multilevel,
                MethodChoice::Relaxed | MethodChoice::Paper => Method::Sweeps,
            },
            omega: match self.method {
                MethodChoice::Paper => Some(1.0),
                _ => self.omega,
            },
            inner: self.inner,
            max_move: self.max_move,
            keep_altitude: self.keep_altitude,
            improve_worst: self.improving.measure(),
            guard: match self.guard {
                GuardChoice::ByMetric => Guard::ByMetric,
                GuardChoice::Worst => Guard::Worst,
            },
            derivatives: match self.derivatives {
                DerivativesChoice::Analytic => Derivatives::Analytic,
                DerivativesChoice::FiniteDifference => Derivatives::FiniteDifference,
            },
            track_all: self.history == History::All,
            ..Options::default()
        };
        let sharpness = match self.edge_norm {
            None => None,
            Some(EdgeNorm::Fixed) => Some(Sharpness::FIXED),
            // What such runs do anyway, as far as the tolerance asks.
            Some(EdgeNorm::Continued) if doubles_anyway(&options) => None,
            Some(EdgeNorm::Continued) => Some(Sharpness::CONTINUED),
        };
        Options { sharpness, ..options }
    }
}

/// Whether the exponent of edge's p-norm doubles anyway.
fn doubles_anyway(options: &Options) -> bool {
    options.is_multilevel() && options.scheme.base() == Metric::Edge
}

impl WorstArgs {
    /// Returns the measure of the worst triangles, if they are to be improved.
    pub(crate) fn measure(&self) -> Option<WorstBy> {
        self.improve_worst.map(|choice| match choice {
            WorstChoice::Imr => WorstBy::Imr,
            WorstChoice::MinAngle => WorstBy::MinAngle,
            WorstChoice::Altitude => WorstBy::Altitude,
        })
    }
}
