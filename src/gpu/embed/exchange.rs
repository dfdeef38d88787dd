//! Positions in a vertex buffer of the application.

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::filled;
use crate::gpu::embed::vertex_buffer::{Coordinates, VertexBuffer};
use crate::gpu::encode::Encoder;
use crate::gpu::kernels::dispatch::dispatch;
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::{Interface, Kernel};
use crate::gpu::kernels::uniforms::{Exchange, pair};
use crate::gpu::mesh::MeshBuffers;
use crate::gpu::scope::scoped_to_buffer;
use crate::layout::Problem;

/// A range of 4-byte words in a buffer, bound from an aligned byte on.
pub(crate) struct Window<'a> {
    buffer: &'a wgpu::Buffer,
    start: u64,
    size: u64,
    /// Words from the start of the binding.
    pub(crate) offset: u32,
}

impl<'a> Window<'a> {
    /// Checks that `bytes` bytes from `offset` on can be bound as storage.
    pub(crate) fn new(
        gpu: &Gpu,
        buffer: &'a wgpu::Buffer,
        offset: u64,
        bytes: u64,
    ) -> Result<Self, GpuError> {
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

    pub(crate) fn binding(&self) -> wgpu::BindingResource<'a> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.buffer,
            offset: self.start,
            size: wgpu::BufferSize::new(self.size),
        })
    }
}

/// A vertex buffer bound to a mesh for import and export. Made by
/// [`DeviceMesh::bind_vertices`](crate::gpu::DeviceMesh::bind_vertices). It keeps the buffer alive, and can be used after
/// the mesh is dropped.
pub struct BoundVertices {
    import: Pipeline,
    export: Pipeline,
    bind_group: wgpu::BindGroup,
    count: u32,
}

impl BoundVertices {
    pub(crate) fn new(
        gpu: &Gpu,
        problem: &Problem,
        vertex_count: usize,
        mesh: &MeshBuffers,
        numbers: &wgpu::Buffer,
        with: &VertexBuffer<'_>,
    ) -> Result<Self, GpuError> {
        let VertexBuffer { buffer, offset, stride, .. } = *with;
        if !stride.is_multiple_of(4) || stride < 8 {
            let problem =
                format!("the stride is {stride} bytes, not a multiple of 4 of at least 8");
            return Err(GpuError::Buffer(problem));
        }
        if stride / 4 > u64::from(u32::MAX) {
            let problem = format!("the stride is {stride} bytes, which is more than 16 GiB");
            return Err(GpuError::Buffer(problem));
        }
        let bytes = (vertex_count as u64 - 1).saturating_mul(stride).saturating_add(8);
        let window = Window::new(gpu, buffer, offset, bytes)?;
        let Coordinates { center, scale } = with.coordinates(problem)?;
        let ([x, x_low], [y, y_low]) = (pair(center.x), pair(center.y));
        let count = problem.positions().len() as u32;
        let exchange = Exchange {
            zero: 0,
            vertices: count,
            offset: window.offset,
            stride: (stride / 4) as u32,
            center: [x, y, x_low, y_low],
            scale: scale as f32,
            inverse_scale: (1.0 / scale) as f32,
            padding: [0; 2],
        };
        let bind_group = scoped_to_buffer(&gpu.device, || {
            let uniform = filled(gpu, "exchange", &[exchange], Usage::UNIFORM);
            let (positions, beyond) = mesh.bind_positions();
            let uniform = uniform.as_entire_binding();
            let mut resources =
                vec![uniform, positions, numbers.as_entire_binding(), window.binding()];
            resources.extend(beyond);
            let positions = mesh.parts.positions();
            gpu.pipelines.bind(&gpu.device, Interface::Exchange, positions, &resources)
        })?;
        let [import, export] = [Kernel::Import, Kernel::Export]
            .map(|kernel| gpu.pipelines.get(&gpu.device, &kernel, mesh.parts.positions()));
        Ok(Self { import: import?, export: export?, bind_group, count })
    }

    /// Encodes the import: when the command buffer runs, all positions, those of fixed vertices too, are read from the
    /// application's vertex buffer.
    ///
    /// A vertex whose floats are those of the last export has not been moved by the application and
    /// keeps its full precision. A position that is not a finite number is not taken: the vertex stays
    /// where it was. Any other floats are taken as moved by the application: where several buffers show one mesh, import
    /// only the one that was exported to last. Two buffers that take turns, each imported and exported in its own frames,
    /// would take the mesh back to where it was two frames ago. The application may have inverted triangles; sweeps then invert no others and improve the rest.
    pub fn encode_import(&self, encoder: &mut impl Encoder) {
        self.encode(encoder, "gpu-smooth import", &self.import);
    }

    /// Encodes the export: when the command buffer runs, x and y of every vertex that a triangle uses are written into
    /// the application's vertex buffer.
    pub fn encode_export(&self, encoder: &mut impl Encoder) {
        self.encode(encoder, "gpu-smooth export", &self.export);
    }

    fn encode(&self, encoder: &mut impl Encoder, label: &'static str, pipeline: &Pipeline) {
        encoder.passes(label).run(pipeline, None, |pass| {
            pass.set_bind_group(0, &self.bind_group, &[]);
            dispatch(pass, self.count);
        });
    }
}
