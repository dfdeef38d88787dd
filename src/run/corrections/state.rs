//! The state of a run with corrections: its stage, levels, estimates and acceleration.

use std::time::Duration;

use super::plan_steps::exponents;
use crate::error::GpuError;
use crate::layout::Problem;
use crate::metric::Metric;
use crate::run::history::History;
use crate::run::plan::Plan;
use crate::run::sweep_params::SweepParams;
use crate::run::truncated::Tail;

/// Number of successive estimates below the tolerance that end a run by EDGE, whose gains are irregular. Each
/// is an estimate of a p-norm near f. One estimate is enough if each of the last gains was less than 0.3 times the gain before (`STEADY` in
/// `record.rs`).
pub(super) const ESTIMATES: usize = 2;

/// Share of the tolerance. If a sweep gains less, and the correction is expected to gain nothing, the run ends.
pub(super) const SWEPT: f64 = 0.1;

/// Smallest number of sweeps alone before corrections begin again, and of sweeps between a refused end and the next
/// measurement.
pub(super) const SWEEPS_BETWEEN: usize = 5;

/// Number of times that corrections begin after a few sweeps alone. Refused once more, corrections wait until sweeps alone
/// would end the run.
pub(super) const ATTEMPTS: u32 = 5;

/// The state of a run with corrections from coarser levels.
pub(crate) struct Corrections {
    pub(super) plan: Plan,
    /// Lower limit of f.
    pub(super) least: f64,
    /// Whether bounds or a guard may forbid the gain of a Newton step.
    pub(super) is_held: bool,
    /// Whether the targets change between sweeps, by a target field, so that the history of f is not a decay.
    pub(super) has_field: bool,
    pub(super) stage: Stage,
    /// Number of times that a stage of corrections has begun.
    pub(super) attempts: u32,
    /// Number of corrections that were applied.
    pub(super) taken: u32,
    /// Number of sweeps with alternating metrics; 0 before the first correction.
    pub(super) alternated: u32,
    /// Whether neither the last correction nor a further sweep can gain anything.
    pub(super) settled: bool,
    /// Slope along the last correction of the present stage. `None` before the first correction.
    pub(super) slope: Option<f64>,
    /// Binary logarithm of the present exponent of EDGE's p-norm.
    pub(super) sharpness: u32,
    /// Objective that corrections lower, f or EDGE's p-norm: one entry for each sweep of the present stage. For f, the
    /// first entry is f before the stage. The p-norm before the stage is unknown.
    pub(super) lowered: Vec<f64>,
    /// Whether corrections are accelerated by secant pairs.
    pub(super) accelerated: bool,
    /// Whether the engine must drop its old secant pairs, as a stage with acceleration begins. `advance` resets the
    /// flag before it returns, so saved states need no such flag.
    pub(super) anew: bool,
    /// Whether the engine has coarser levels.
    pub(super) has_levels: bool,
    /// History indices of the latest build of the levels, and of the latest build or fit.
    pub(super) built: usize,
    pub(super) fitted: usize,
    /// Latest estimates of the remaining gain as a share of f, infinite for a missing estimate.
    pub(super) estimates: [f64; ESTIMATES],
    /// The error of an engine without room for the levels. Such a run makes no corrections.
    pub(super) left_out: Option<GpuError>,
    /// Whether a reopening of flat triangles followed a doubling of the exponent, with or without success. No further
    /// reopening follows.
    pub(super) was_reopened: bool,
    /// Whether the engine of the saved state, from which the run continues, had no room for the levels.
    pub(super) was_left_out: bool,
    /// Number of refused ends, and the index in the history before which no end is measured.
    pub(super) refused_ends: u32,
    pub(super) unmeasured_until: usize,
    /// Time of building and fitting the levels.
    pub(super) levels_time: Duration,
    /// State of the Newton steps of all vertices.
    pub(super) tail: Tail,
    /// Whether the run takes Newton steps where corrections would first begin.
    pub(super) can_step: bool,
}

/// The state of the stage that corrects sweeps.
#[derive(Clone, Copy)]
pub(super) struct Correcting {
    /// Index in the history at which the stage began.
    pub(super) since: usize,
    /// Length of the last applied correction.
    pub(super) length: f64,
    /// Number of corrections computed in this stage, with the present levels.
    pub(super) proposed: u32,
    /// Number of refused corrections since the latest accepted correction.
    pub(super) refused: u32,
}

/// The stages of a run. `since` and `until` are indices in the history.
#[derive(Clone, Copy)]
pub(super) enum Stage {
    /// Sweeps alone at least up to `until`, and then while each sweep gains enough. The metrics of the scheme take
    /// turns until corrections have begun once; later sweeps are by the base metric.
    Before { until: usize },
    /// Sweeps by the base metric, each followed by a correction.
    Correcting(Correcting),
    /// Sweeps by the base metric, each followed by a Newton step of all vertices. `left` is the gain that remains after the
    /// last step, as a share of f, if known.
    Stepping { left: Option<f64> },
    /// Sweeps alone by the base metric to the end of the run, because corrections do not help or the engine has no room
    /// for the levels.
    Without { since: usize },
}

impl Corrections {
    /// Creates the state at the start of a run. `has_field` is whether a target field changes the targets between sweeps.
    pub(crate) fn new(problem: &Problem, plan: &Plan, has_field: bool) -> Self {
        Self {
            plan: plan.clone(),
            least: plan.scheme.base().least_objective(problem.mean_varies()),
            is_held: problem.is_bounded() || plan.base_step(1.0).shape_guard.is_finite(),
            has_field,
            stage: Stage::Before { until: 1 },
            attempts: 0,
            taken: 0,
            alternated: 0,
            settled: false,
            slope: None,
            sharpness: *exponents(plan).start(),
            lowered: Vec::new(),
            accelerated: false,
            anew: false,
            has_levels: false,
            built: 0,
            fitted: 0,
            estimates: [f64::INFINITY; ESTIMATES],
            left_out: None,
            was_reopened: false,
            was_left_out: false,
            refused_ends: 0,
            unmeasured_until: 0,
            levels_time: Duration::ZERO,
            tail: Tail::new(),
            can_step: can_step(problem, plan, has_field),
        }
    }

    /// Returns the time of building and fitting the levels, from the readback of the stiffness to the upload.
    pub(crate) fn levels_time(&self) -> Duration {
        self.levels_time
    }

    /// Returns the number of sweeps with alternating metrics. `None` before the first correction.
    pub(crate) fn alternated(&self) -> Option<u32> {
        (self.attempts > 0).then_some(self.alternated)
    }

    /// Returns whether Newton steps of all vertices may follow the sweeps.
    pub(crate) fn can_step(&self) -> bool {
        self.can_step
    }

    /// Returns whether a Newton step of all vertices measures the remaining gain at the end.
    pub(crate) fn is_measured(&self) -> bool {
        self.metric().curved().is_some() && !self.has_field
    }

    /// Returns the number of Newton steps of all vertices, and of iterations in all steps.
    pub(crate) fn steps_taken(&self) -> [u32; 2] {
        self.tail.counts()
    }

    /// Returns the number of applied corrections.
    pub(crate) fn taken(&self) -> u32 {
        self.taken
    }

    /// Returns the error of an engine without room for the levels, with which the run makes no corrections.
    pub(crate) fn left_out(&self) -> Option<&GpuError> {
        self.left_out.as_ref()
    }

    /// Returns true if the run makes no corrections, as the present or an earlier engine lacks room for the levels.
    pub(crate) fn is_left_out(&self) -> bool {
        self.was_left_out || self.left_out.is_some()
    }

    pub(super) fn metric(&self) -> Metric {
        self.plan.scheme.base()
    }

    /// Returns a step of the base metric, with the present exponent.
    pub(super) fn step(&self, omega: f64) -> SweepParams {
        self.plan.step_with(self.metric(), omega, self.sharpness)
    }

    /// Begins a stage of corrections after `done` evaluations. `length` is the first length to try. Estimates and
    /// slopes of earlier stages are dropped.
    pub(super) fn begin_correcting(&mut self, done: usize, length: f64) {
        // EDGE's p-norm is always much stiffer across its kinks than along them, which the levels do not represent.
        (self.slope, self.accelerated) = (None, !self.metric().is_smooth());
        self.anew = self.accelerated;
        self.estimates = [f64::INFINITY; ESTIMATES];
        self.lowered.clear();
        self.stage = Stage::Correcting(Correcting { since: done, length, proposed: 0, refused: 0 });
    }

    /// Records that the host has moved vertices or changed targets. Earlier gains then predict nothing, and secant
    /// pairs belong to other positions. `f` is the objective at the new state.
    pub(crate) fn disturbed(&mut self, f: f64) {
        (self.slope, self.settled) = (None, false);
        self.estimates = [f64::INFINITY; ESTIMATES];
        if let Stage::Correcting(state) = &mut self.stage {
            state.refused = 0;
            self.lowered.clear();
            self.lowered.extend(self.metric().is_smooth().then_some(f));
        }
    }

    /// Returns the excess of f over its lower limit, at an index in the history.
    pub(super) fn excess(&self, history: &History, evaluation: usize) -> f64 {
        history.f()[evaluation] - self.least
    }
}

/// Returns whether a run can end by Newton steps of all vertices. Stages between the sweeps, bounds of moves and altitudes,
/// and a guard that holds triangles of any metric, refuse most of such steps. By SHAPE-SIZE, which is not convex in map and
/// area, a run on a graded mesh came to a saddle: the bound of the remaining gain does not see it, and 3e-5 of f were left
/// of reported 1e-6.
fn can_step(problem: &Problem, plan: &Plan, has_field: bool) -> bool {
    let base = plan.scheme.base();
    let is_convex = base.curved().is_some() && base != Metric::ShapeSize;
    is_convex && !has_field && !problem.is_bounded() && plan.worst_guard.is_infinite()
}
