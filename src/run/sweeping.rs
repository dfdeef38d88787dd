//! Runs of sweeps alone. The decay of f proposes the end of a run, and the gain of a Newton step of all vertices, which moves no
//! vertex, confirms it: slow modes may hide in the decay.

use crate::error::GpuError;
use crate::options::Method;
use crate::run::engine::Engine;
use crate::run::history::History;
use crate::run::named::Named;
use crate::run::plan::Plan;
use crate::run::progress::GoesOn;
use crate::run::stop::{MIN_SCALE, NOISE, Stop};
use crate::run::sweeps;
use crate::run::truncated::Tail;

/// Factor on the tolerance of the decay after a refused end, beside the ratio of the tolerance and the measured gain.
const TIGHTENED: f64 = 0.5;
/// Name of the tolerance of the decay in a saved state.
const TOLERANCE: &str = "tolerance of the decay";

/// The state of a run of sweeps alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sweeping {
    /// Estimated remaining gain, as a share of f, with which the decay of f may end the run.
    tolerance: f64,
    /// Whether the end of the run is measured.
    is_measured: bool,
    /// Whether a measured gain above the tolerance refuses the end of the run.
    may_refuse_end: bool,
}

impl Sweeping {
    /// Creates the state at the start of a run. `is_held` is whether bounds or a target field keep vertices from the minimum
    /// of f.
    ///
    /// By the paper's method, if metrics alternate, and with a guard of triangles, the decay alone decides where a run ends, and the
    /// measured gain is reported: alternating metrics need not lead to the minimum of the base metric, and a guard may forbid
    /// the gain.
    pub(crate) fn new(plan: &Plan, method: Method, is_held: bool) -> Self {
        let base = plan.scheme.base();
        let is_guarded = plan.base_step(1.0).shape_guard.is_finite();
        Self {
            tolerance: plan.stop.tolerance,
            is_measured: base.curved().is_some() && !is_held,
            may_refuse_end: !plan.scheme.alternates()
                && !is_guarded
                && !matches!(method, Method::Paper(_)),
        }
    }

    /// Returns whether a Newton step of all vertices measures the remaining gain at the end.
    pub(crate) fn is_measured(&self) -> bool {
        self.is_measured && self.tolerance > 0.0
    }

    /// Does up to `sweeps` further sweeps of the plan, fewer if the run ends.
    pub(crate) async fn advance(
        &mut self,
        engine: &mut impl Engine,
        plan: &Plan,
        history: &mut History,
        sweeps: u32,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<(), GpuError> {
        sweeps::advance(engine, plan, history, sweeps).await?;
        if history.stop() != Some(Stop::Converged) || !self.is_measured {
            return Ok(());
        }
        let f = history.last().max(MIN_SCALE);
        let request = Tail::measuring(f, plan.stop.tolerance);
        let Some(left) = engine.remaining(&plan.base_step(1.0), &request, goes_on).await? else {
            return Ok(());
        };
        let left = (left / f).max(NOISE);
        let decays = history.remaining().is_some_and(|left| left <= self.tolerance);
        if left <= plan.stop.tolerance || !decays || !self.may_refuse_end {
            history.end(history.stop(), Some(left));
            return Ok(());
        }
        self.tolerance *= TIGHTENED * plan.stop.tolerance / left;
        history.end(None, Some(left));
        self.set_tolerance(engine, history)
    }

    /// Makes the engine and the history judge the decay by the present tolerance.
    fn set_tolerance(
        self,
        engine: &mut impl Engine,
        history: &mut History,
    ) -> Result<(), GpuError> {
        history.set_tolerance(self.tolerance);
        engine.go_on(self.tolerance)
    }

    /// Returns the state for [`restore`](Self::restore).
    pub(crate) fn save(self) -> Named {
        let mut out = Named::default();
        out.add(TOLERANCE, self.tolerance);
        out
    }

    /// Restores the state that [`save`](Self::save) returned. Returns false for an invalid state.
    pub(crate) fn restore(
        &mut self,
        from: &Named,
        engine: &mut impl Engine,
        history: &mut History,
    ) -> Result<bool, GpuError> {
        let tolerance = from.one(TOLERANCE).filter(|t| (0.0..=self.tolerance).contains(t));
        let Some(tolerance) = tolerance else { return Ok(false) };
        if tolerance < self.tolerance {
            self.tolerance = tolerance;
            self.set_tolerance(engine, history)?;
        }
        Ok(true)
    }
}
