//! Positions and objectives in buffers of the application.

use wgpu::BufferUsages as Usage;

use super::buffers::filled;
use super::device::{Gpu, GpuError, scoped};
use super::layout::{Exchange, Publish, SLOTS, pair};
use super::shaders::{Interface, Kernel};
use crate::metric::Metric;
use crate::problem::Problem;

/// Where an application keeps its vertices: f32 x and y of vertex i at `offset + i * stride`.
///
/// What follows y within the stride, a z or anything else, is neither read nor written.
#[derive(Clone, Copy, Debug)]
pub struct VertexBuffer<'a> {
    /// The buffer, with usage `STORAGE` beside what the application needs.
    pub buffer: &'a wgpu::Buffer,
    /// Bytes before the x of vertex 0, a multiple of 4.
    pub offset: u64,
    /// Bytes from one vertex to the next, a multiple of 4, at least 8.
    pub stride: u64,
}

/// A place of floats in a buffer, as the kernels see it: bound from an aligned byte on.
struct Window<'a> {
    buffer: &'a wgpu::Buffer,
    start: u64,
    size: u64,
    /// Floats from the start of the binding.
    offset: u32,
}

impl<'a> Window<'a> {
    /// Checks that `bytes` bytes from `offset` on can be bound as storage.
    fn new(gpu: &Gpu, buffer: &'a wgpu::Buffer, offset: u64, bytes: u64) -> Result<Self, GpuError> {
        let refuse = |problem: String| Err(GpuError::Buffer(problem));
        if !buffer.usage().contains(Usage::STORAGE) {
            let usage = buffer.usage();
            return refuse(format!("it was made for {usage:?}, and needs STORAGE as well"));
        }
        if !offset.is_multiple_of(4) {
            return refuse(format!("the offset is {offset} bytes, not a multiple of 4"));
        }
        let Some(end) = offset.checked_add(bytes).filter(|&end| end <= buffer.size()) else {
            let size = buffer.size();
            return refuse(format!(
                "it has {size} bytes, and {bytes} from byte {offset} are needed"
            ));
        };
        let limits = gpu.device.limits();
        let alignment = u64::from(limits.min_storage_buffer_offset_alignment);
        let start = offset - offset % alignment;
        let size = end - start;
        if size > limits.max_storage_buffer_binding_size {
            return Err(GpuError::Limit {
                what: "the application's buffer".into(),
                needed: size,
                limit: "max_storage_buffer_binding_size",
                available: limits.max_storage_buffer_binding_size,
            });
        }
        Ok(Self { buffer, start, size, offset: ((offset - start) / 4) as u32 })
    }

    fn binding(&self) -> wgpu::BindingResource<'a> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.buffer,
            offset: self.start,
            size: wgpu::BufferSize::new(self.size),
        })
    }
}

/// A vertex buffer bound to a mesh for import and export.
pub(crate) fn bind_vertices(
    gpu: &Gpu,
    problem: &Problem,
    vertex_count: usize,
    positions: &wgpu::Buffer,
    numbers: &wgpu::Buffer,
    with: &VertexBuffer<'_>,
) -> Result<wgpu::BindGroup, GpuError> {
    let VertexBuffer { buffer, offset, stride } = *with;
    if !stride.is_multiple_of(4) || stride < 8 || stride / 4 > u64::from(u32::MAX) {
        let problem = format!("the stride is {stride} bytes, not a multiple of 4 of at least 8");
        return Err(GpuError::Buffer(problem));
    }
    let bytes = (vertex_count as u64 - 1).saturating_mul(stride).saturating_add(8);
    let window = Window::new(gpu, buffer, offset, bytes)?;
    let (center, scale) = problem.normalization();
    let ([x, x_low], [y, y_low]) = (pair(center.x), pair(center.y));
    let exchange = Exchange {
        zero: 0,
        vertices: problem.positions().len() as u32,
        offset: window.offset,
        stride: (stride / 4) as u32,
        center: [x, y, x_low, y_low],
        scale: scale as f32,
        inverse_scale: (1.0 / scale) as f32,
        padding: [0; 2],
    };
    scoped(&gpu.device, || {
        let uniform = filled(gpu, "exchange", &[exchange], Usage::UNIFORM);
        let resources = [
            uniform.as_entire_binding(),
            positions.as_entire_binding(),
            numbers.as_entire_binding(),
            window.binding(),
        ];
        gpu.pipelines.bind(&gpu.device, Interface::Exchange, &resources)
    })
}

/// A place for objectives bound to a run.
pub(crate) fn bind_objectives(
    gpu: &Gpu,
    triangles: usize,
    tracked: &[Metric],
    control: &wgpu::Buffer,
    buffer: &wgpu::Buffer,
    offset: u64,
) -> Result<wgpu::BindGroup, GpuError> {
    let window = Window::new(gpu, buffer, offset, (SLOTS * size_of::<f32>()) as u64)?;
    let mut ideal_squared = [[0.0; 4]; 2];
    for &metric in tracked {
        let slot = metric as usize;
        ideal_squared[slot / 4][slot % 4] = metric.ideal_squared() as f32;
    }
    let publish = Publish {
        offset: window.offset,
        triangles: triangles as u32,
        padding: [0; 2],
        ideal_squared,
    };
    scoped(&gpu.device, || {
        let uniform = filled(gpu, "publish", &[publish], Usage::UNIFORM);
        let resources =
            [uniform.as_entire_binding(), control.as_entire_binding(), window.binding()];
        gpu.pipelines.bind(&gpu.device, Interface::Publish, &resources)
    })
}

/// The pipeline of one of the kernels that exchange.
pub(crate) fn pipeline(gpu: &Gpu, kernel: Kernel) -> Result<wgpu::ComputePipeline, GpuError> {
    gpu.pipelines.get(&gpu.device, &kernel)
}
