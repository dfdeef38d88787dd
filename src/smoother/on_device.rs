//! Upload of a prepared mesh to a device.

use crate::error::SmoothError;
use crate::gpu::{DeviceMesh, Gpu};
use crate::slide::Sliding;

use super::prepared::Smoother;

impl Smoother<'_> {
    /// Uploads the mesh as [`DeviceMesh::new`] does, but reuses the prepared layout and targets: only the upload
    /// remains, and sweeps reproduce the bits of a run. Only a mesh with [`Mesh::fixed`](crate::Mesh::fixed) vertices
    /// is laid out again. A field of targets is evaluated once, at the vertices before a run.
    ///
    /// After [`set_slide`](Self::set_slide), [`Sweeps`](crate::gpu::Sweeps) slide vertices along their curves, partners
    /// together. A vertex that the application moves along its curve goes on sliding from its new place, and a vertex that
    /// it moves off the curve stays there until it is back. Pins and masks hold sliding vertices too, with their partners.
    /// On a projected mesh no vertex slides.
    ///
    /// After [`project_from_sphere`](Self::project_from_sphere), vertices on the device move in the Mercator projection.
    /// Vertex buffers have coordinates of the projection, and are declared by
    /// [`VertexBuffer::in_mercator_projection`](crate::gpu::VertexBuffer::in_mercator_projection);
    /// [`DeviceMesh::read_points`] returns longitudes and latitudes. If the projection would invert slivers, the vertices
    /// near the slivers begin at their moved positions, as in a run, so export before the first import. Sweeps keep the
    /// signs of triangles in the projection; [`certify`](Self::certify) checks the points that are read.
    ///
    /// # Errors
    /// [`SmoothError::Gpu`] with [`GpuError::Limit`](crate::GpuError::Limit) if the mesh is too large for the device,
    /// and [`SmoothError::Mesh`] if every vertex is on the boundary or in no triangle. Vertices of
    /// [`Mesh::fixed`](crate::Mesh::fixed) are held by pins, so a mesh whose other vertices are fixed is accepted.
    pub fn to_device(&self, gpu: &Gpu) -> Result<DeviceMesh, SmoothError> {
        if let Some(opened) = &self.opened {
            return opened.to_device(gpu);
        }
        let slide = self.slide.as_ref().filter(|_| !self.problem.is_projected());
        let sliding = slide.map(|slide| Sliding::new(&self.mesh.points, &self.topology, slide));
        DeviceMesh::of(gpu, &self.mesh, &self.problem, sliding)
    }
}
