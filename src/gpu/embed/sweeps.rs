//! Sweeps for an application's command encoder.

use std::sync::Arc;

use crate::error::GpuError;
use crate::error::SmoothError;
use crate::gpu::embed::BoundObjective;
use crate::gpu::embed::DeviceMesh;
use crate::gpu::encode::Encoder;
use crate::gpu::run::Dispatches;
use crate::run::Options;

/// A scheme bound to a mesh on the device. Encodes sweeps into the application's command encoder; never submits, never
/// reads back, never stops by itself.
///
/// Several schemes can be bound to one mesh, and the sweeps of several meshes interleaved in one encoder.
pub struct Sweeps {
    gpu: crate::gpu::Gpu,
    dispatches: Arc<Dispatches>,
    triangles: usize,
    done: u32,
}

impl Sweeps {
    /// Binds the scheme, relaxation and derivatives of `options` to a mesh.
    ///
    /// What `options` say on stopping has no effect here, nor does [`Options::method`]: a correction from coarser levels
    /// takes a line search, which the host would have to wait for. Without corrections a large mesh converges in
    /// hundreds of sweeps instead of a dozen. Metrics without a barrier (RMS, EDGE, AREA) leave no triangle with an
    /// inverse mean ratio above 30 unless its patch had a worse one.
    ///
    /// Compiles kernels that are not compiled yet; [`Gpu::prepare`](crate::gpu::Gpu::prepare) does so beforehand.
    ///
    /// # Errors
    /// [`SmoothError::Option`] for an option out of its range, or what the device refuses.
    pub fn new(mesh: &DeviceMesh, options: &Options) -> Result<Self, SmoothError> {
        options.check()?;
        let plan = options.plan().endless();
        let steps = plan.steps();
        let DeviceMesh { gpu, problem, buffers, .. } = mesh;
        let dispatches = Arc::new(Dispatches::new(gpu, problem, buffers, plan, steps, false)?);
        let triangles = mesh.problem.triangles().len();
        Ok(Self { gpu: mesh.gpu.clone(), dispatches, triangles, done: 0 })
    }

    /// Encodes `sweeps` further sweeps. The scheme goes on where the last call left it,
    /// whether or not that encoder was submitted: alternate metrics and over-relaxation count the sweeps that were encoded.
    pub fn encode_sweeps(&mut self, encoder: &mut impl Encoder, sweeps: u32) {
        let mut passes = encoder.passes("gpu-smooth sweeps");
        for _ in 0..sweeps {
            self.done = self.done.saturating_add(1);
            self.dispatches.encode_sweep(&mut passes, &self.dispatches.plan.step(self.done));
        }
    }

    /// Starts the scheme anew, with plain sweeps before over-relaxed ones. To be called when the application has moved
    /// vertices far.
    pub fn restart(&mut self) {
        self.done = 0;
    }

    /// Binds a place in a buffer of the application for the objectives, the bytes of
    /// [`ObjectiveValues`](crate::gpu::ObjectiveValues) from byte `offset` on.
    ///
    /// # Errors
    /// [`GpuError::Buffer`] if the buffer is too small, misaligned or was made without `STORAGE`.
    pub fn bind_objective(
        &self,
        buffer: &wgpu::Buffer,
        offset: u64,
    ) -> Result<BoundObjective, GpuError> {
        BoundObjective::new(&self.gpu, &self.dispatches, self.triangles, buffer, offset)
    }
}
