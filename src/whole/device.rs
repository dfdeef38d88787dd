//! The device on which a run sweeps, and its engine.

use glam::DVec2;

use crate::error::GpuError;
use crate::gpu::{Gpu, GpuEngine, Waiting};
use crate::layout::Problem;
use crate::mesh::MeshSize;
use crate::run::{Plan, Work};
use crate::slide::OnCurves;

/// The engine on a device.
pub(crate) type DeviceEngine<'s> = Box<GpuEngine<'s>>;

/// A device, and whether a run blocks or awaits until the device has results.
#[derive(Clone, Copy)]
pub(crate) struct Device<'s> {
    gpu: &'s Gpu,
    waiting: Waiting,
}

impl<'s> Device<'s> {
    /// Returns the device of a run. If the run `is_awaited`, the application polls the device; otherwise the thread of the run
    /// blocks for results.
    pub(crate) fn new(gpu: &'s Gpu, is_awaited: bool) -> Self {
        let waiting = if is_awaited { Waiting::Await } else { Waiting::Block };
        Self { gpu, waiting }
    }

    /// Checks the size of a mesh, and fails if the device has too little room.
    pub(crate) fn check_size(self, size: MeshSize) -> Result<(), GpuError> {
        self.gpu.check_size(size)
    }

    /// Checks the arithmetic of the device, and fails if kernels lose digits of pairs of floats.
    pub(crate) async fn check_arithmetic(self) -> Result<(), GpuError> {
        self.gpu.arithmetic_checked(self.waiting).await
    }

    /// Returns an engine for a run by `plan`, which may do the given work; see [`GpuEngine::new`].
    pub(crate) async fn engine(
        self,
        problem: &Problem,
        from: &[DVec2],
        curves: Option<&OnCurves>,
        plan: Plan,
        work: Work,
    ) -> Result<DeviceEngine<'s>, GpuError> {
        GpuEngine::new(self.gpu, problem, from, curves, plan, work, self.waiting)
            .await
            .map(Box::new)
    }
}
