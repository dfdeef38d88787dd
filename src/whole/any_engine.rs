//! The engine of a run, which the CPU engine may replace after a failure of the device, or where triangles are too flat for it.

use std::borrow::Cow;

use glam::DVec2;

use crate::cpu::CpuEngine;
use crate::error::GpuError;
use crate::layout::Problem;
use crate::metric::Smoothing;
use crate::run::multilevel::Hierarchy;
use crate::run::truncated::{NewtonStep, StepRequest};
use crate::run::{Engine, EngineState, GoesOn, History, Objectives, Proposal, SweepParams};
use crate::slide::OnCurves;
use crate::whole::device::DeviceEngine;

/// The CPU engine or the engine of a device, by one interface.
pub(crate) enum AnyEngine<'g> {
    Cpu(Box<CpuEngine>),
    Device(DeviceEngine<'g>),
}

/// Calls a method on the engine inside an [`AnyEngine`].
macro_rules! on {
    ($self:ident, $engine:ident => $call:expr) => {
        match $self {
            AnyEngine::Cpu($engine) => $call,
            #[cfg(feature = "gpu")]
            AnyEngine::Device($engine) => $call,
            #[cfg(not(feature = "gpu"))]
            AnyEngine::Device(none) => match **none {},
        }
    };
}

impl AnyEngine<'_> {
    /// Returns the sliding vertices of the state whose positions [`Engine::best_positions`] returns. `None` if no vertex
    /// slides.
    pub(crate) async fn best_curves(&self) -> Result<Option<OnCurves>, GpuError> {
        on!(self, engine => engine.best_curves().await)
    }
}

impl Engine for AnyEngine<'_> {
    fn problem(&self) -> &Problem {
        on!(self, engine => engine.problem())
    }

    fn noise(&self) -> f64 {
        on!(self, engine => engine.noise())
    }

    async fn sweep(&mut self, step: &SweepParams) -> Result<Objectives, GpuError> {
        on!(self, engine => engine.sweep(step).await)
    }

    async fn objectives(&mut self) -> Result<Objectives, GpuError> {
        on!(self, engine => engine.objectives().await)
    }

    async fn sweeps(
        &mut self,
        steps: &[SweepParams],
        history: &mut History,
    ) -> Result<(), GpuError> {
        on!(self, engine => engine.sweeps(steps, history).await)
    }

    fn set_positions(&mut self, positions: &[DVec2]) -> Result<(), GpuError> {
        on!(self, engine => engine.set_positions(positions))
    }

    fn set_maps(&mut self, problem: &Problem) -> Result<(), GpuError> {
        on!(self, engine => engine.set_maps(problem))
    }

    async fn positions(&mut self) -> Result<Cow<'_, [DVec2]>, GpuError> {
        on!(self, engine => engine.positions().await)
    }

    async fn best_positions(&mut self) -> Result<Vec<DVec2>, GpuError> {
        on!(self, engine => engine.best_positions().await)
    }

    fn take_hierarchy(&mut self) -> Option<Hierarchy> {
        on!(self, engine => engine.take_hierarchy())
    }

    async fn set_hierarchy(&mut self, hierarchy: Hierarchy) -> Result<(), GpuError> {
        on!(self, engine => engine.set_hierarchy(hierarchy).await)
    }

    async fn stiffness_roots(&mut self, smoothing: Smoothing) -> Result<Vec<f32>, GpuError> {
        on!(self, engine => engine.stiffness_roots(smoothing).await)
    }

    async fn sweep_and_propose(
        &mut self,
        step: &SweepParams,
        length: f64,
        accelerated: bool,
    ) -> Result<Proposal, GpuError> {
        on!(self, engine => engine.sweep_and_propose(step, length, accelerated).await)
    }

    async fn sweep_and_step(
        &mut self,
        step: &SweepParams,
        request: &StepRequest,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<Option<NewtonStep>, GpuError> {
        on!(self, engine => engine.sweep_and_step(step, request, goes_on).await)
    }

    async fn remaining(
        &mut self,
        step: &SweepParams,
        request: &StepRequest,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<Option<f64>, GpuError> {
        let left = on!(self, engine => engine.remaining(step, request, goes_on).await)?;
        let AnyEngine::Device(engine) = self else { return Ok(left) };
        let most = 2.0 * request.least_gain * request.objective;
        if left.is_some_and(|left| left <= most) || !goes_on() {
            return Ok(left);
        }
        // In single precision, rounding looks like a gain or like negative curvature, and a device takes no steps on some meshes.
        #[cfg(feature = "gpu")]
        {
            let curves = engine.best_curves().await?;
            let positions = engine.positions().await?.into_owned();
            let problem = engine.problem();
            Ok(crate::cpu::remaining(problem, &positions, curves, step, request, goes_on).await)
        }
        #[cfg(not(feature = "gpu"))]
        match **engine {}
    }

    fn go_on(&mut self, tolerance: f64) -> Result<(), GpuError> {
        on!(self, engine => engine.go_on(tolerance))
    }

    fn forget(&mut self) {
        on!(self, engine => engine.forget());
    }

    async fn exclude_broken(&mut self, length: f64, anew: bool) -> Result<Proposal, GpuError> {
        on!(self, engine => engine.exclude_broken(length, anew).await)
    }

    async fn excess_along(&mut self, length: f64) -> Result<Option<f64>, GpuError> {
        on!(self, engine => engine.excess_along(length).await)
    }

    async fn move_along(&mut self, length: f64) -> Result<(), GpuError> {
        on!(self, engine => engine.move_along(length).await)
    }

    async fn objectives_after_move(&mut self, length: f64) -> Result<Objectives, GpuError> {
        on!(self, engine => engine.objectives_after_move(length).await)
    }

    async fn save(&mut self, whole: bool) -> Result<EngineState, GpuError> {
        on!(self, engine => engine.save(whole).await)
    }

    async fn restore(&mut self, state: &EngineState) -> Result<bool, GpuError> {
        on!(self, engine => engine.restore(state).await)
    }
}
