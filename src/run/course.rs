//! The control of the sweeps of a run: sweeps alone, or sweeps with corrections from coarser levels.

use std::time::Duration;

use crate::error::GpuError;
use crate::layout::Problem;
use crate::options::Options;
use crate::run::corrections::Corrections;
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::named::Named;
use crate::run::plan::Plan;
use crate::run::progress::GoesOn;
use crate::run::sweeping::Sweeping;
use crate::run::work::{Ending, Work};

/// The control of the sweeps of a run. Its state determines which sweeps, corrections and steps follow, and when they end.
pub(crate) enum Course {
    /// Sweeps alone.
    Sweeps(Sweeping),
    /// Sweeps with corrections from coarser levels.
    Corrected(Box<Corrections>),
}

impl Course {
    /// Creates the state at the start of a run. `has_field` is whether a target field changes the targets between sweeps.
    pub(crate) fn new(problem: &Problem, plan: &Plan, options: &Options, has_field: bool) -> Self {
        if Self::is_corrected(problem, options) {
            return Self::Corrected(Box::new(Corrections::new(problem, plan, has_field)));
        }
        let is_held = has_field || problem.is_bounded() || problem.free_count() == 0;
        Self::Sweeps(Sweeping::new(plan, options.method, is_held))
    }

    /// Returns whether corrections from coarser levels follow the sweeps of a run.
    fn is_corrected(problem: &Problem, options: &Options) -> bool {
        options.is_multilevel() && problem.free_count() > 0
    }

    /// Returns the work of a run by `plan`.
    pub(crate) fn work(&self, plan: &Plan) -> Work {
        match self {
            Self::Sweeps(sweeping) => {
                Work { is_measured: sweeping.is_measured(), ..Work::of_sweeps(plan.steps()) }
            }
            Self::Corrected(corrections) => Work {
                steps: Corrections::steps(plan),
                ending: if corrections.can_step() { Ending::Steps } else { Ending::Corrections },
                is_measured: corrections.is_measured(),
            },
        }
    }

    /// Returns whether corrections let the host decide after each sweep whether the run ends, so that a device must not end the
    /// run. In a run with a target field, the host decides too, by the session.
    pub(crate) fn is_judged_by_host(&self) -> bool {
        matches!(self, Self::Corrected(_))
    }

    /// Does up to `sweeps` further sweeps of the plan, fewer if the run ends. Engines ask `goes_on` in the middle of long steps.
    pub(crate) async fn advance(
        &mut self,
        engine: &mut impl Engine,
        plan: &Plan,
        history: &mut History,
        sweeps: u32,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<(), GpuError> {
        match self {
            Self::Sweeps(sweeping) => {
                sweeping.advance(engine, plan, history, sweeps, goes_on).await
            }
            Self::Corrected(corrections) => {
                corrections.advance(engine, history, sweeps, goes_on).await
            }
        }
    }

    /// Returns the error of an engine without room for the coarser levels. The run then makes no corrections.
    pub(crate) fn left_out(&self) -> Option<&GpuError> {
        match self {
            Self::Sweeps(_) => None,
            Self::Corrected(corrections) => corrections.left_out(),
        }
    }

    /// Records that the host has moved vertices or changed targets. `f` is the objective at the new state.
    pub(crate) fn disturbed(&mut self, f: f64) {
        if let Self::Corrected(corrections) = self {
            corrections.disturbed(f);
        }
    }

    /// Returns the state for [`restore`](Self::restore).
    pub(crate) fn save(&self) -> Named {
        match self {
            Self::Sweeps(sweeping) => sweeping.save(),
            Self::Corrected(corrections) => corrections.save(),
        }
    }

    /// Restores the state that [`save`](Self::save) returned. `has_levels` tells whether the saved engine had coarser levels.
    /// Returns false for an invalid state.
    pub(crate) fn restore(
        &mut self,
        from: &Named,
        engine: &mut impl Engine,
        history: &mut History,
        has_levels: bool,
    ) -> Result<bool, GpuError> {
        match self {
            Self::Sweeps(sweeping) => sweeping.restore(from, engine, history),
            Self::Corrected(corrections) => {
                Ok(corrections.restore(from, history.log().len(), has_levels))
            }
        }
    }

    /// Returns the counts of sweeps and corrections for the report, after `sweeps` sweeps.
    pub(crate) fn counts(&self, sweeps: u32) -> Counts {
        match self {
            Self::Sweeps(_) => Counts { alternated: sweeps, ..Counts::NONE },
            Self::Corrected(corrections) => Counts {
                alternated: corrections.alternated().unwrap_or(sweeps),
                corrections: corrections.taken(),
                newton_steps: corrections.steps_taken()[0],
                newton_iterations: corrections.steps_taken()[1],
                levels_left_out: corrections.is_left_out(),
                levels: corrections.levels_time(),
            },
        }
    }
}

/// The counts of sweeps and corrections in the report of a run.
#[derive(Clone, Copy)]
pub(crate) struct Counts {
    /// Number of sweeps with alternating metrics. In runs with corrections, metrics alternate only before the first
    /// correction.
    pub(crate) alternated: u32,
    pub(crate) corrections: u32,
    /// Number of Newton steps of all vertices, and of iterations of conjugate gradients in all of them.
    pub(crate) newton_steps: u32,
    pub(crate) newton_iterations: u32,
    pub(crate) levels_left_out: bool,
    /// Time of building and fitting the coarser levels.
    pub(crate) levels: Duration,
}

impl Counts {
    /// The counts of a run without sweeps.
    pub(crate) const NONE: Self = Self {
        alternated: 0,
        corrections: 0,
        newton_steps: 0,
        newton_iterations: 0,
        levels_left_out: false,
        levels: Duration::ZERO,
    };
}
