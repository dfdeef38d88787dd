//! Upload of a prepared mesh to a device.

use crate::error::SmoothError;
use crate::gpu::{DeviceMesh, Gpu};

use super::prepared::Smoother;

impl Smoother<'_> {
    /// Uploads the mesh as [`DeviceMesh::new`] does, but reuses the prepared layout and targets: only the upload
    /// remains, and sweeps reproduce the bits of a run. Only a mesh with [`Mesh::fixed`](crate::Mesh::fixed) vertices
    /// is laid out again. A field of targets is evaluated once, at the vertices before a run; no vertex slides on a
    /// device.
    ///
    /// # Errors
    /// [`SmoothError::Gpu`] with [`GpuError::Limit`](crate::GpuError::Limit) if the mesh is too large for the device,
    /// and [`SmoothError::Mesh`] if no vertex is free.
    pub fn to_device(&self, gpu: &Gpu) -> Result<DeviceMesh, SmoothError> {
        DeviceMesh::of(gpu, &self.mesh, &self.problem)
    }
}
