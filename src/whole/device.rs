//! The device of a run.

use glam::DVec2;

use crate::error::GpuError;
use crate::gpu::{Gpu, GpuEngine, Waiting};
use crate::layout::Problem;
use crate::mesh::MeshSize;
use crate::run::{Plan, Step};

/// The engine on a device.
pub(crate) type DeviceEngine<'s> = Box<GpuEngine<'s>>;

/// A device, and how a run waits for it.
#[derive(Clone, Copy)]
pub(crate) struct Device<'s> {
    gpu: &'s Gpu,
    waiting: Waiting,
}

impl<'s> Device<'s> {
    /// A device for which the thread of the run waits.
    pub(crate) fn blocking(gpu: &'s Gpu) -> Self {
        Self { gpu, waiting: Waiting::Block }
    }

    /// A device that the application polls while it awaits the run.
    pub(crate) fn awaited(gpu: &'s Gpu) -> Self {
        Self { gpu, waiting: Waiting::Await }
    }

    /// Fails if a mesh of this size does not fit the device.
    pub(crate) fn check_size(self, size: MeshSize) -> Result<(), GpuError> {
        self.gpu.check_size(size)
    }

    /// Fails if the device drops digits.
    pub(crate) async fn check_arithmetic(self) -> Result<(), GpuError> {
        self.gpu.arithmetic_checked(self.waiting).await
    }

    /// Returns an engine for a run by a plan that may take `steps`; see [`GpuEngine::new`].
    pub(crate) fn engine(
        self,
        problem: &Problem,
        from: &[DVec2],
        plan: Plan,
        steps: Vec<Step>,
    ) -> Result<DeviceEngine<'s>, GpuError> {
        GpuEngine::new(self.gpu, problem, from, plan, steps, self.waiting).map(Box::new)
    }
}
