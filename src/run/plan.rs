//! The plan of a run, common to all engines: the step of each sweep, and the stop rule.

use crate::metric::{Metric, Scheme};
use crate::options::{Derivatives, Options, PNormExponent, Paper};
use crate::run::line_search::{self, LONGEST};
use crate::run::stop::StopRule;
use crate::run::sweep_params::SweepParams;

/// The parameters that determine the sweeps of a run on every engine.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Metrics of the sweeps, in turn.
    pub scheme: Scheme,
    /// Over-relaxation factor by metric, in the order of [`Metric::ALL`].
    pub omega: [f64; Metric::ALL.len()],
    /// Number of sweeps before over-relaxation starts.
    pub unrelaxed_sweeps: u32,
    /// Largest number of Newton steps in one visit of a vertex.
    pub newton_steps: u32,
    /// Method of differentiation by metric, in the order of [`Metric::ALL`].
    pub derivatives: [Derivatives; Metric::ALL.len()],
    /// Exponent of EDGE's p-norm, sweep by sweep.
    pub sharpness: PNormExponent,
    /// The rule by which the run ends.
    pub stop: StopRule,
    /// Whether the history holds the objective of every metric, or of the base metric alone.
    pub track_all: bool,
    /// Shape guard of metrics without a barrier: the largest inverse mean ratio of a triangle after a step. A patch
    /// that already had a worse triangle may keep a triangle as bad. A smaller
    /// [`shape_guard`](crate::metric::Properties::shape_guard) of the metric replaces this number.
    pub shape_guard: f64,
    /// Guard of all metrics: the largest inverse mean ratio of a triangle after a step. A patch that already had a
    /// worse triangle may keep a triangle as bad. Infinite for no guard.
    pub worst_guard: f64,
    /// Upper limit of the factor by which steps of metrics with a barrier are lengthened, where nearly flat triangles
    /// make up most of a patch's objective. 1 turns lengthening off.
    pub max_lengthening: f64,
    /// Whether a penalty keeps sweeps by EDGE away from the shape guard, as in runs with corrections.
    pub is_guard_penalized: bool,
}

impl Plan {
    /// Returns the plan of sweeps with the given options, for code that drives sweeps itself. The plan has no
    /// [`Goal`](crate::Goal) and no corrections from coarser levels.
    pub fn new(options: &Options) -> Self {
        Self::with(options, None, options.edge_norm.unwrap_or(PNormExponent::FIXED))
    }

    /// Returns the plan of a run with the given options. If `goal` is given, the run ends when the base objective
    /// falls below it.
    pub(crate) fn toward(options: &Options, goal: Option<f64>) -> Self {
        // If another metric judges sweeps by EDGE, such sweeps are few, so the exponent of the p-norm stays fixed.
        let is_corrected_edge = options.is_multilevel() && !options.scheme.base().is_smooth();
        let usual = match (is_corrected_edge, goal) {
            (true, Some(_)) => PNormExponent::CORRECTED,
            (true, None) => PNormExponent::corrected_to(options.stopping.tolerance()),
            (false, _) => PNormExponent::FIXED,
        };
        let plan = Self::with(options, goal, options.edge_norm.unwrap_or(usual));
        Self { is_guard_penalized: is_corrected_edge, ..plan }
    }

    fn with(options: &Options, goal: Option<f64>, sharpness: PNormExponent) -> Self {
        let (relaxed, paper) = (options.method.relaxed(), options.method.paper());
        let own = |metric: Metric| match options.scheme.alternates() {
            true => 1.0,
            false => metric.properties().omega,
        };
        let mut omega = [1.0; Metric::ALL.len()];
        for (slot, metric) in omega.iter_mut().zip(Metric::ALL) {
            *slot = relaxed.omega.unwrap_or(own(*metric));
        }
        let Paper { newton_steps, derivatives } = paper;
        let tolerance = options.stopping.tolerance();
        Self {
            scheme: options.scheme.clone(),
            omega,
            unrelaxed_sweeps: relaxed.unrelaxed_sweeps,
            newton_steps: newton_steps.max(1),
            derivatives: [derivatives; Metric::ALL.len()],
            sharpness,
            stop: StopRule { goal, tolerance, max_sweeps: options.max_sweeps },
            track_all: options.track_all,
            shape_guard: f64::INFINITY,
            worst_guard: f64::INFINITY,
            max_lengthening: if options.is_multilevel() { LONGEST } else { 1.0 },
            is_guard_penalized: false,
        }
    }

    /// Returns the step of a sweep. Sweeps count from 1.
    pub fn step(&self, sweep: u32) -> SweepParams {
        let metric = self.scheme.metric(sweep);
        let omega = if sweep <= self.unrelaxed_sweeps { 1.0 } else { self.omega[metric as usize] };
        self.step_with(metric, omega, self.sharpness.of(sweep))
    }

    /// Returns all distinct steps that [`step`](Self::step) can return.
    pub(crate) fn steps(&self) -> Vec<SweepParams> {
        let PNormExponent { first, last, .. } = self.sharpness;
        let mut steps = Vec::new();
        for &metric in self.scheme.metrics() {
            for omega in [1.0, self.omega[metric as usize]] {
                for sharpness in first..=last.max(first) {
                    let step = self.step_with(metric, omega, sharpness);
                    if !steps.contains(&step) {
                        steps.push(step);
                    }
                }
            }
        }
        steps
    }

    /// Returns a step of the base metric with over-relaxation `omega`, for runs with corrections.
    pub(crate) fn base_step(&self, omega: f64) -> SweepParams {
        self.step_with(self.scheme.base(), omega, self.sharpness.largest())
    }

    /// Returns a step of `metric` with over-relaxation `omega`. `sharpness` is the binary logarithm of EDGE's exponent.
    pub(crate) fn step_with(&self, metric: Metric, omega: f64, sharpness: u32) -> SweepParams {
        let of_metric = match metric.properties().shape_guard {
            own if own.is_finite() => self.shape_guard.min(own),
            own => own,
        };
        let guard = of_metric.min(self.worst_guard);
        let is_penalized = self.is_guard_penalized && metric == Metric::Edge;
        SweepParams {
            metric,
            omega,
            newton_steps: self.newton_steps,
            sharpness,
            penalty_guard: if is_penalized { guard } else { f64::INFINITY },
            derivatives: self.derivatives[metric as usize],
            shape_guard: guard * (1.0 - line_search::GUARD_RESERVE),
            max_lengthening: if metric.properties().barrier { self.max_lengthening } else { 1.0 },
        }
    }

    /// Returns the plan without a stop rule, for a run that the caller ends.
    pub(crate) fn endless(mut self) -> Self {
        self.stop = StopRule { goal: None, tolerance: 0.0, max_sweeps: u32::MAX };
        self
    }

    /// Returns whether every sweep lowers the base objective, so that the last state is the best. Sweeps with finite
    /// differences may raise the objective, as their minimum is slightly off.
    pub fn is_monotone(&self) -> bool {
        let base = self.scheme.base();
        self.scheme.is_monotone() && self.derivatives[base as usize] == Derivatives::Analytic
    }

    /// Returns the metrics whose objectives are evaluated after each sweep.
    pub fn tracked(&self) -> Vec<Metric> {
        if self.track_all { Metric::ALL.to_vec() } else { vec![self.scheme.base()] }
    }
}
