//! Copies positions to and from a vertex buffer of the application.

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::filled;
use crate::gpu::embed::vertex_buffer::{Coordinates, VertexBuffer};
use crate::gpu::encode::Encoder;
use crate::gpu::kernels::dispatch::dispatch;
use crate::gpu::kernels::layouts::ExchangeBindings;
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{Exchange, pair};
use crate::gpu::mesh::MeshBuffers;
use crate::gpu::scope::scoped_to_buffer;
use crate::layout::Problem;

/// A vertex buffer bound to a mesh for import and export. Created by
/// [`DeviceMesh::bind_vertices`](crate::gpu::DeviceMesh::bind_vertices). A `BoundVertices` keeps the buffer alive, and
/// is usable after the mesh is dropped.
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
        let stride = with.words()?;
        let window = with.window(gpu, vertex_count)?;
        let Coordinates { center, scale } = with.coordinates(problem)?;
        let ([x, x_low], [y, y_low]) = (pair(center.x), pair(center.y));
        let count = problem.positions().len() as u32;
        let exchange = Exchange {
            zero: 0,
            vertices: count,
            offset: window.offset,
            stride,
            center: [x, y, x_low, y_low],
            scale: scale as f32,
            inverse_scale: (1.0 / scale) as f32,
            padding: [0; 2],
        };
        let bind_group = scoped_to_buffer(&gpu.device, || {
            let uniform = filled(gpu, "exchange", &[exchange], Usage::UNIFORM);
            let bindings = ExchangeBindings {
                exchange: uniform.as_entire_binding(),
                positions: mesh.bind_positions(),
                numbers: numbers.as_entire_binding(),
                vertex_buffer: window.binding(),
                changes: mesh.changes.buffer.as_entire_binding(),
            };
            gpu.pipelines.bind(&gpu.device, mesh.parts.form(), bindings)
        })?;
        let [import, export] = [Kernel::Import, Kernel::Export]
            .map(|kernel| gpu.pipelines.get(&gpu.device, &kernel, mesh.parts.form()));
        Ok(Self { import: import?, export: export?, bind_group, count })
    }

    /// Encodes the import. When the command buffer runs, the positions of all vertices, including fixed vertices, are
    /// read from the application's vertex buffer.
    ///
    /// The buffer must hold the positions: before the first import, the application has written them, or has encoded an
    /// [export](Self::encode_export). An import from an empty buffer moves all vertices to the origin.
    ///
    /// A vertex whose floats equal its position as exported has not been moved by the application, and keeps its full
    /// precision. Different floats count as a move by the application. Infinite and NaN coordinates are ignored, and
    /// the vertex stays in place.
    ///
    /// If several buffers show one mesh, import only the buffer of the last export. If two buffers take turns, each
    /// imported and exported in its own frames, the mesh would go back to its positions two frames ago.
    ///
    /// The application may have inverted triangles. Sweeps then invert no further triangles and improve the rest, and
    /// [`UntanglingSweeps`](crate::gpu::UntanglingSweeps) turn inverted triangles back.
    pub fn encode_import(&self, encoder: &mut impl Encoder) {
        self.encode(encoder, "gpu-smooth import", &self.import);
    }

    /// Encodes the export. When the command buffer runs, x and y of every vertex that a triangle uses are written into
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
