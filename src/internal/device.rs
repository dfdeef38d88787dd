//! Functions for benchmarks, experiments and tests of the GPU engine.

use glam::DVec2;

use crate::gpu::{Gpu, GpuEngine, GpuError, Waiting};
use crate::layout::Problem;
use crate::parallel::pace::now;
use crate::run::{Plan, Stepwise, StepwiseRun, Work};

pub use crate::gpu::scope::DeviceCounts;
pub use crate::gpu::{BindLayout, Kernel};

/// Returns the counts of the work that the library has given to a device since the device was opened.
pub fn device_counts(gpu: &Gpu) -> DeviceCounts {
    gpu.counts()
}

/// Starts a run of sweeps on a device from `positions`, which are normalized and in the problem's order.
///
/// # Errors
/// [`GpuError::Limit`] if the mesh is too large for the device, or another [`GpuError`] if the device fails.
pub fn run_on_gpu<'a>(
    gpu: &'a Gpu,
    problem: &'a Problem,
    positions: &'a [DVec2],
    plan: Plan,
) -> Result<impl Stepwise + 'a, GpuError> {
    let work = Work::of_sweeps(plan.steps());
    let engine =
        now(GpuEngine::new(gpu, problem, positions, None, plan.clone(), work, Waiting::Block))?;
    Ok(StepwiseRun::new(engine, plan))
}
