//! Restores a mesh to its last valid state.

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::{filled, rows};
use crate::gpu::device::size::POSITION;
use crate::gpu::encode::Encoder;
use crate::gpu::kernels::dispatch::dispatch;
use crate::gpu::kernels::layouts::RestoreBindings;
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{Restore, split};
use crate::gpu::mesh::MeshBuffers;
use crate::gpu::run::Dispatches;
use crate::gpu::scope::scoped;
use crate::layout::Problem;
use crate::options::Options;
use crate::parallel::pace::now;
use crate::run::Plan;

/// The last valid positions of a mesh. Created by
/// [`DeviceMesh::keep_last_valid`](crate::gpu::DeviceMesh::keep_last_valid), and usable after the mesh is dropped.
pub struct LastValid {
    evaluation: Dispatches,
    restore: Pipeline,
    /// Bind group and number of vertices, per part of the mesh.
    parts: Vec<(wgpu::BindGroup, u32)>,
}

impl LastValid {
    pub(crate) fn new(gpu: &Gpu, problem: &Problem, mesh: &MeshBuffers) -> Result<Self, GpuError> {
        let plan = Plan::new(&Options::default()).endless();
        let evaluation = now(Dispatches::new(gpu, problem, mesh, plan, Vec::new(), false))?;
        let form = mesh.parts.form();
        let restore = gpu.pipelines.get(&gpu.device, &Kernel::RestoreLastValid, form)?;
        let parts = scoped(&gpu.device, || {
            let valid: Vec<[f32; 4]> = problem.positions().iter().map(|&p| split(p)).collect();
            let valid = filled(gpu, "last valid positions", &valid, Usage::STORAGE);
            let bind = |part: &std::ops::Range<u32>| {
                let (first, count) = (part.start, part.end - part.start);
                let uniform = Restore { zero: 0, first, count, padding: 0 };
                let uniform = filled(gpu, "restore", &[uniform], Usage::UNIFORM);
                let bindings = RestoreBindings {
                    restore: uniform.as_entire_binding(),
                    positions: mesh.bind_positions(),
                    valid_positions: rows(&valid, part, POSITION),
                    control: evaluation.control.as_entire_binding(),
                    changes: mesh.changes.buffer.as_entire_binding(),
                };
                (gpu.pipelines.bind(&gpu.device, form, bindings), count)
            };
            mesh.parts.vertices.iter().map(bind).collect()
        })?;
        Ok(Self { evaluation, restore, parts })
    }

    /// Encodes saving or restoring. When the command buffer runs, the positions of a mesh without inverted or flat
    /// triangles are saved. A mesh with inverted or flat triangles returns to the last saved positions or, before the
    /// first save, to the uploaded positions. All vertices return, including the boundary. Encode this call before the
    /// export, so that the application's vertices return too.
    ///
    /// The call evaluates f and copies positions, which takes the device less time than a sweep.
    pub fn encode_restore_last_valid(&self, encoder: &mut impl Encoder) {
        let mut passes = encoder.passes("gpu-smooth restore");
        self.evaluation.encode_evaluation(&mut passes);
        for (bound, count) in &self.parts {
            passes.run(&self.restore, None, |pass| {
                pass.set_bind_group(0, bound, &[]);
                dispatch(pass, *count);
            });
        }
    }
}
