//! The state of a run with corrections, and its stages.

use super::plan_steps::exponents;
use crate::error::GpuError;
use crate::layout::Problem;
use crate::metric::Metric;
use crate::run::history::History;
use crate::run::plan::Plan;
use crate::run::step::Step;

/// Number of estimates in a row that must agree before a run with accelerated corrections ends, as its gains are
/// irregular. One is enough if the last gains were each less than 0.3 times (`STEADY` in `record.rs`) the one before.
pub(super) const ESTIMATES: usize = 4;

/// The state of a run with corrections from coarser levels.
pub(crate) struct Corrections {
    pub(super) problem: Problem,
    pub(super) plan: Plan,
    pub(super) stage: Stage,
    /// Number of times that corrections have begun.
    pub(super) attempts: u32,
    /// Number of corrections taken.
    pub(super) taken: u32,
    /// Number of sweeps after which corrections began for the first time; 0 before.
    pub(super) alternated: u32,
    /// Whether the last correction was expected to gain nothing.
    pub(super) settled: bool,
    /// The slope along the last correction of the present stage.
    pub(super) slope: Option<f64>,
    /// log2 of the present exponent of EDGE's p-norm.
    pub(super) sharpness: u32,
    /// The objective that corrections lower, f or EDGE's p-norm, after each sweep of the present stage. For f it begins
    /// with the value before the stage; that of the p-norm is not known.
    pub(super) lowered: Vec<f64>,
    /// Whether corrections are accelerated by secant pairs.
    pub(super) accelerated: bool,
    /// Whether the engine is to forget the pairs that it has. Never so between two sweeps.
    pub(super) anew: bool,
    /// Whether the engine has levels.
    pub(super) has_levels: bool,
    /// The indices in the history at which the levels were built, and at which they were last built or fitted.
    pub(super) built: usize,
    pub(super) fitted: usize,
    /// The latest estimates of the share of f that is left to gain, infinite if there is none.
    pub(super) estimates: [f64; ESTIMATES],
    /// The error if there are no corrections, as the engine has no room for the levels.
    pub(super) left_out: Option<GpuError>,
    /// Whether triangles that lie flat at a low exponent have been reopened after it had doubled, or cannot be.
    pub(super) was_reopened: bool,
    /// Whether the engine had no room for the levels before the run continued from a saved state.
    pub(super) was_left_out: bool,
}

/// The stage of corrections.
#[derive(Clone, Copy)]
pub(super) struct Correcting {
    /// The index in the history at which the stage began.
    pub(super) since: usize,
    /// The length of the last correction taken.
    pub(super) length: f64,
    /// The number of corrections tried in this stage.
    pub(super) proposed: u32,
    /// The number of corrections refused in a row at the end.
    pub(super) refused: u32,
}

/// The stage of a run. `since` and `until` are indices in the history.
#[derive(Clone, Copy)]
pub(super) enum Stage {
    /// Sweeps alone, at least up to `until`, and then as long as they gain enough: by the metrics of the scheme in
    /// turn, or by the base metric once corrections have been tried.
    Before { until: usize },
    /// Each sweep, by the base metric, is followed by a correction.
    Correcting(Correcting),
    /// Sweeps alone by the base metric to the end, as corrections do not help or the engine has no room for the
    /// levels.
    Without { since: usize },
}

impl Corrections {
    /// Makes the state at the start of a run.
    pub(crate) fn new(problem: &Problem, plan: &Plan) -> Self {
        Self {
            problem: problem.clone(),
            plan: plan.clone(),
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
        }
    }

    /// Returns the number of sweeps in which the metrics of the scheme took turns, once these are over.
    pub(crate) fn alternated(&self) -> Option<u32> {
        (self.attempts > 0).then_some(self.alternated)
    }

    /// Returns the number of corrections taken so far.
    pub(crate) fn taken(&self) -> u32 {
        self.taken
    }

    /// Returns the error if the run has no corrections, as the engine has no room for the levels.
    pub(crate) fn left_out(&self) -> Option<&GpuError> {
        self.left_out.as_ref()
    }

    /// Whether the run has no corrections, as the engine has no room for the levels.
    pub(crate) fn is_left_out(&self) -> bool {
        self.was_left_out || self.left_out.is_some()
    }

    pub(super) fn metric(&self) -> Metric {
        self.plan.scheme.base()
    }

    /// Returns a step of the base metric, with the present exponent.
    pub(super) fn step(&self, omega: f64) -> Step {
        self.plan.step_with(self.metric(), omega, self.sharpness)
    }

    /// Begins a stage of corrections after `done` evaluations, with this length. What came before says nothing about it.
    pub(super) fn begin_correcting(&mut self, done: usize, length: f64) {
        // EDGE's p-norm is always much stiffer across its kinks than along them, which the levels do not know.
        (self.slope, self.accelerated) = (None, !self.metric().is_smooth());
        self.anew = self.accelerated;
        self.estimates = [f64::INFINITY; ESTIMATES];
        self.lowered.clear();
        self.stage = Stage::Correcting(Correcting { since: done, length, proposed: 0, refused: 0 });
    }

    /// Takes note that the host has moved vertices, or has changed targets: what sweeps gained before tells nothing about later
    /// ones, and secant pairs are of other positions. `f` is the objective now.
    pub(crate) fn disturbed(&mut self, f: f64) {
        (self.slope, self.settled) = (None, false);
        self.estimates = [f64::INFINITY; ESTIMATES];
        if let Stage::Correcting(state) = &mut self.stage {
            state.refused = 0;
            self.lowered.clear();
            self.lowered.extend(self.metric().is_smooth().then_some(f));
        }
    }

    /// Takes the targets of a problem with the same layout.
    pub(crate) fn set_targets(&mut self, problem: &Problem) {
        self.problem = problem.clone();
    }

    /// Returns the excess of the base objective over its ideal value, at an index of the history.
    pub(super) fn excess(&self, history: &History, evaluation: usize) -> f64 {
        history.f()[evaluation] - self.metric().ideal_squared()
    }
}
