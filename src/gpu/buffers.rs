//! A mesh on the device.

use glam::DVec2;
use wgpu::BufferUsages as Usage;

use super::device::{Gpu, GpuError, scoped};
use super::layout::split;
use crate::problem::Problem;

/// The buffers that live as long as a mesh stays on the device.
pub(crate) struct MeshBuffers {
    pub(crate) positions: wgpu::Buffer,
    pub(crate) ring_start: wgpu::Buffer,
    pub(crate) ring: wgpu::Buffer,
    pub(crate) triangles: wgpu::Buffer,
}

/// How large a mesh is, for [`Gpu::required_limits`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshSize {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
}

impl MeshSize {
    /// The bytes of each buffer that grows with the mesh. Of the one-rings, which hold each corner
    /// of a triangle at most once, the bound.
    fn buffers(self) -> [(&'static str, u64); 3] {
        let (vertices, triangles) = (self.vertices as u64, self.triangles as u64);
        [
            ("the buffer of vertex positions", vertices * size_of::<[f32; 4]>() as u64),
            ("the buffer of triangles", triangles * size_of::<[u32; 3]>() as u64),
            ("the buffer of one-rings", triangles * 3 * size_of::<u32>() as u64),
        ]
    }

    /// The largest buffer.
    pub(crate) fn largest(self) -> u64 {
        self.buffers().into_iter().map(|(_, bytes)| bytes).fold(0, u64::max)
    }

    /// Fails if a buffer does not fit the limits: checked before anything is allocated, as a limit met
    /// halfway helps nobody.
    pub(crate) fn check(self, limits: &wgpu::Limits) -> Result<(), GpuError> {
        self.buffers().into_iter().try_for_each(|(what, needed)| {
            check_binding(limits, || format!("{what} ({} vertices)", self.vertices), needed)
        })
    }
}

/// Fails if a buffer of `needed` bytes cannot be made or bound.
pub(crate) fn check_binding(
    limits: &wgpu::Limits,
    what: impl Fn() -> String,
    needed: u64,
) -> Result<(), GpuError> {
    for (limit, available) in [
        ("max_storage_buffer_binding_size", limits.max_storage_buffer_binding_size),
        ("max_buffer_size", limits.max_buffer_size),
    ] {
        if needed > available {
            return Err(GpuError::Limit { what: what(), needed, limit, available });
        }
    }
    Ok(())
}

impl MeshBuffers {
    /// Uploads a problem with its vertices at `positions`.
    pub(crate) fn new(gpu: &Gpu, problem: &Problem, positions: &[DVec2]) -> Result<Self, GpuError> {
        let size = MeshSize { vertices: positions.len(), triangles: problem.triangles().len() };
        size.check(&gpu.device.limits())?;
        let positions: Vec<[f32; 4]> = positions.iter().map(|&p| split(p)).collect();
        scoped(&gpu.device, || Self {
            positions: filled(gpu, "positions", &positions, Usage::STORAGE | Usage::COPY_SRC),
            ring_start: filled(
                gpu,
                "ring starts",
                problem.ring_start(),
                Usage::STORAGE | Usage::COPY_DST,
            ),
            ring: filled(gpu, "one-rings", problem.ring(), Usage::STORAGE),
            triangles: filled(gpu, "triangles", problem.triangles(), Usage::STORAGE),
        })
    }
}

/// A buffer holding `contents`. To be called in an error scope.
pub(crate) fn filled<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    label: &str,
    contents: &[T],
    usage: Usage,
) -> wgpu::Buffer {
    let bytes: &[u8] = bytemuck::cast_slice(contents);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(&format!("gpu-smooth {label}")),
        size: (bytes.len() as u64).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT),
        usage,
        mapped_at_creation: true,
    });
    // A device that is lost or out of memory maps nothing, and the error scope hears of it: no reason
    // to panic, as wgpu's own `create_buffer_init` does.
    if let Ok(mut view) = buffer.get_mapped_range_mut(..) {
        view.slice(..bytes.len()).copy_from_slice(bytes);
    }
    buffer.unmap();
    buffer
}

/// A buffer of zeros. To be called in an error scope.
pub(crate) fn zeroed(gpu: &Gpu, label: &str, size: u64, usage: Usage) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(&format!("gpu-smooth {label}")),
        size,
        usage,
        mapped_at_creation: false,
    })
}
