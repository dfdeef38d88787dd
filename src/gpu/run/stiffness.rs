//! Computes the stiffness of the base metric at the free vertices on the device.

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::{filled, uniform, zeroed};
use crate::gpu::device::pending::Waiting;
use crate::gpu::device::readback::{self, Copied};
use crate::gpu::encode::sealed::Target;
use crate::gpu::kernels::dispatch::dispatch;
use crate::gpu::kernels::layouts::FineBindings;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{FineOp, NO_GUARD};
use crate::gpu::mesh::{MeshBuffers, RingPart};
use crate::gpu::run::dispatches::Dispatches;
use crate::gpu::scope::scoped;
use crate::metric::Smoothing;
use crate::parallel::pace::pause;
use crate::parallel::paced;
use crate::run::multilevel::NONE;

/// Computes the square root of the stiffness at each of `free` vertices, with EDGE made smooth by `smoothing`; see
/// [`Engine::stiffness_roots`](crate::run::Engine::stiffness_roots).
pub(crate) async fn roots(
    gpu: &Gpu,
    mesh: &MeshBuffers,
    dispatches: &Dispatches,
    free: u32,
    smoothing: Smoothing,
    waiting: Waiting,
) -> Result<Vec<f32>, GpuError> {
    let form = mesh.parts.form();
    let kernel = Kernel::Stiffness(dispatches.plan.scheme.base());
    let pipeline = gpu.pipelines.get(&gpu.device, &kernel, form)?;
    pause().await;
    let alignment = gpu.device.limits().min_uniform_buffer_offset_alignment;
    let stride = (size_of::<FineOp>() as u32).next_multiple_of(alignment);
    let bytes = operations(&mesh.parts.rings, stride, free, smoothing);
    let (ops, found, unused) = scoped(&gpu.device, || {
        let ops = filled(gpu, "stiffness steps", &bytes, Usage::UNIFORM);
        let size = u64::from(free) * size_of::<[f32; 2]>() as u64;
        let found = zeroed(gpu, "stiffness", size, Usage::STORAGE | Usage::COPY_SRC);
        // The kernel does not use these two bindings of its layout.
        let unused = ["no correction", "no vectors"]
            .map(|label| zeroed(gpu, label, size_of::<[f32; 2]>() as u64, Usage::STORAGE));
        (ops, found, unused)
    })?;
    let [direction, vectors] = &unused;
    let encode = |encoder: &mut wgpu::CommandEncoder| {
        let mut passes = encoder.passes("gpu-smooth stiffness");
        for (part, RingPart { vertices, .. }) in mesh.parts.rings.iter().enumerate() {
            let bindings = FineBindings {
                params: dispatches.params.as_entire_binding(),
                op: uniform::<FineOp>(&ops),
                positions: mesh.bind_positions(),
                ring_start: mesh.ring_start.as_entire_binding(),
                ring: mesh.bind_ring(part),
                triangles: mesh.bind_elements(0),
                gradient: found.as_entire_binding(),
                direction: direction.as_entire_binding(),
                vectors: vectors.as_entire_binding(),
            };
            let bound = gpu.pipelines.bind(&gpu.device, form, bindings);
            passes.run(&pipeline, None, |pass| {
                pass.set_bind_group(0, &bound, &[part as u32 * stride]);
                dispatch(pass, vertices.end - vertices.start);
            });
        }
    };
    let roots: Copied<'_, [f32; 2]> =
        readback::submit_and_copy(gpu, encode, &found, free as usize)?;
    let roots = roots.values(waiting).await?;
    Ok(paced::collect(roots.len(), |v| roots[v][0]).await)
}

/// Returns the operations of all parts of the one-rings as bytes, `stride` bytes apart.
fn operations(rings: &[RingPart], stride: u32, free: u32, smoothing: Smoothing) -> Vec<u8> {
    let mut bytes = vec![0_u8; stride as usize * rings.len()];
    for (RingPart { vertices, entries }, to) in
        rings.iter().zip(bytes.chunks_exact_mut(stride as usize))
    {
        let op = FineOp {
            rows: vertices.end - vertices.start,
            first: vertices.start,
            free,
            ring_base: entries.start,
            present_roots: NONE,
            unbroken: 0,
            partial_sums: 0,
            length: 0.0,
            shape_guard: NO_GUARD as f32,
            sharpness: 0,
            inverse_penalty_guard: 0.0,
            padding: 0,
        };
        let op = op.smoothed(smoothing);
        to[..size_of::<FineOp>()].copy_from_slice(bytemuck::bytes_of(&op));
    }
    bytes
}
