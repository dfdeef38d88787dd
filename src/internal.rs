//! Functions for benchmarks, experiments and this library's own tests, which change without notice.

#[cfg(feature = "gpu")]
mod device;

use glam::DVec2;

use crate::cpu::CpuEngine;
use crate::metric::Own;
use crate::run::StepwiseRun;
use crate::untangle::energy::Corner;

#[cfg(feature = "gpu")]
pub use device::{BindLayout, DeviceCounts, Kernel, device_counts, run_on_gpu, time_step};

pub use crate::layout::{Coloring, Problem, UNCOLORED, prepare};
pub use crate::metric::{Dual, Invariants, Properties, Real};
pub use crate::run::{Plan, Stepwise, StopRule, SweepParams};

/// Starts a run of sweeps on the CPU from `positions`, which are normalized and in the problem's order.
pub fn run_on_cpu<'a>(problem: &'a Problem, positions: &[DVec2], plan: Plan) -> impl Stepwise + 'a {
    StepwiseRun::new(CpuEngine::new(problem, positions.to_vec(), None, &plan), plan)
}

/// Returns the energy that untangling lowers, for a triangle of desired area `target` spanned by two `edges` from a
/// corner: the value, the gradient (x, y) and the Hessian (xx, xy, yy) by the position of the corner.
pub fn untangling_energy(edges: [[f64; 2]; 2], target: f64, epsilon: f64) -> [f64; 6] {
    let corner = Corner { edges, inverse_target: 1.0 / target };
    let Dual { value, gradient: [x, y], hessian: [xx, xy, yy] } = corner.expansion(Own, epsilon);
    [value, x, y, xx, xy, yy]
}
