//! Functions for benchmarks, experiments and tests of the GPU engine.

use glam::DVec2;

use crate::gpu::{Gpu, GpuEngine, GpuError, Span, Timestamps, Waiting};
use crate::layout::Problem;
use crate::parallel::pace::now;
use crate::run::corrections::Corrections;
use crate::run::truncated::StepRequest;
use crate::run::{Ending, Engine, Plan, Stepwise, StepwiseRun, Work};

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

/// Times the kernels of a Newton step of all vertices on a device, after a number of sweeps from the positions of a problem. The
/// step has the given number of iterations of conjugate gradients. `None` if the plan or the mesh has no such steps on a device.
///
/// # Errors
/// [`GpuError::Limit`] if the mesh is too large for the device, or another [`GpuError`] if the device fails.
pub fn time_step(
    gpu: &Gpu,
    problem: &Problem,
    plan: Plan,
    sweeps: u32,
    iterations: u32,
    timestamps: &mut Timestamps,
) -> Result<Option<Vec<Span>>, GpuError> {
    let steps = Corrections::steps(&plan);
    let takes_steps = Corrections::new(problem, &plan, false).can_step();
    let Some(&sweep) = steps.first().filter(|_| takes_steps) else { return Ok(None) };
    let work = Work { steps, ending: Ending::Steps, is_measured: false };
    let positions = problem.positions();
    let engine = GpuEngine::new(gpu, problem, positions, None, plan, work, Waiting::Block);
    let mut engine = now(engine)?;
    for _ in 0..sweeps {
        now(engine.sweep(&sweep))?;
    }
    // No accuracy ends the iterations early.
    let request = StepRequest {
        objective: 1.0,
        forcing: 0.0,
        least_gain: 0.0,
        least_ritz: 1e-3,
        is_exact: true,
    };
    now(engine.timed_step(&request, iterations, timestamps))
}
