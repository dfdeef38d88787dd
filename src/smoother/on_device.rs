//! The upload of a prepared mesh to a device, and runs that are awaited.

use crate::error::SmoothError;
use crate::gpu::{DeviceMesh, Gpu};
use crate::outcome::Outcome;
use crate::run::{NoKeeper, Observer, Options};
use crate::whole::Device;

use super::calls::unobserved;
use super::prepared::Smoother;

impl Smoother<'_> {
    /// Uploads the mesh as [`DeviceMesh::new`] does, with the layout and the targets that are prepared already: sweeps
    /// then give the same bits, and no more than the upload is left to do. Only a mesh with
    /// [`Mesh::fixed`](crate::Mesh::fixed) vertices is laid out again. A field of targets is taken as it is at the
    /// vertices before a run; nothing slides on a device.
    ///
    /// # Errors
    /// [`SmoothError::Gpu`] with [`GpuError::Limit`](crate::GpuError::Limit) if the mesh is too large for the device, and
    /// [`SmoothError::Mesh`] if no vertex is free.
    pub fn to_device(&self, gpu: &Gpu) -> Result<DeviceMesh, SmoothError> {
        DeviceMesh::of(gpu, &self.mesh, &self.problem)
    }

    /// Smooths the mesh on a device without blocking the thread while the device works.
    ///
    /// The future completes only if the application polls the device meanwhile, as one that draws frames does
    /// (`Device::poll` with `PollType::Poll` is enough). Dropping the future cancels the run without a result. The
    /// future is `Send`.
    ///
    /// # Errors
    /// [`SmoothError::Option`] or [`SmoothError::Gpu`]; [`run`](Self::run) gives the conditions.
    pub async fn run_async(&self, options: &Options, gpu: &Gpu) -> Result<Outcome, SmoothError> {
        self.run_async_observed(options, gpu, &mut unobserved).await
    }

    /// Smooths the mesh as [`run_async`](Self::run_async) does. `observe` is called every few sweeps and can end the run; the best
    /// state so far is then returned. The future is `Send` if `observe` is.
    ///
    /// # Errors
    /// [`SmoothError::Option`] or [`SmoothError::Gpu`]; [`run`](Self::run) gives the conditions.
    pub async fn run_async_observed(
        &self,
        options: &Options,
        gpu: &Gpu,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Outcome, SmoothError> {
        self.run_at(options, Some(Device::awaited(gpu)), None, &mut NoKeeper, observe).await
    }
}
