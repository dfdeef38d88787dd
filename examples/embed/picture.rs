//! Plain wgpu, which an application has anyway: pipelines that draw the mesh, here into a picture instead of a window.

use gpu_smooth::{Mesh, wgpu};
use wgpu::BufferUsages as Usage;
use wgpu::util::DeviceExt;

use super::{Result, Vertex};

pub(crate) const WIDTH: u32 = 960;
pub(crate) const HEIGHT: u32 = 640;
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const SAMPLES: u32 = 4;

/// A drawing of a mesh from a vertex buffer: faces colored by shape, and edges.
pub(crate) struct Picture {
    faces: wgpu::RenderPipeline,
    edges: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
    edge_indices: wgpu::Buffer,
    edge_count: u32,
    triangle_count: u32,
    samples: wgpu::Texture,
    image: wgpu::Texture,
}

impl Picture {
    pub(crate) fn new(device: &wgpu::Device, mesh: &Mesh, vertices: &wgpu::Buffer) -> Self {
        let filled = |label, contents: &[u8], usage| {
            let label = Some(label);
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label, contents, usage })
        };
        let view = filled("view", bytemuck::bytes_of(&view_of(mesh)), Usage::UNIFORM);
        let triangles = bytemuck::cast_slice(&mesh.triangles);
        let triangles = filled("triangles", triangles, Usage::STORAGE);
        let edges = edges_of(mesh);
        let edge_indices = filled("edges", bytemuck::cast_slice(&edges), Usage::INDEX);

        let visibility = wgpu::ShaderStages::VERTEX;
        let binding = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        // Shaders also read the vertex buffer as storage, because the color of a face depends on its three corners.
        let read_only = wgpu::BufferBindingType::Storage { read_only: true };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("picture"),
            entries: &[
                binding(0, wgpu::BufferBindingType::Uniform),
                binding(1, read_only),
                binding(2, read_only),
            ],
        });
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("picture"),
            layout: &layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: view.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: vertices.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: triangles.as_entire_binding() },
            ],
        });

        let texture = |label, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: WIDTH, height: HEIGHT, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format: FORMAT,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            })
        };
        Self {
            faces: pipeline(device, &layout, "faces"),
            edges: pipeline(device, &layout, "edges"),
            bind_group,
            edge_indices,
            edge_count: edges.len() as u32,
            triangle_count: mesh.triangles.len() as u32,
            samples: texture("samples", SAMPLES, wgpu::TextureUsages::empty()),
            image: texture("image", 1, wgpu::TextureUsages::COPY_SRC),
        }
    }

    /// Encodes the drawing of the mesh. The drawing uses the buffer's content at the time of execution.
    pub(crate) fn draw(&self, encoder: &mut wgpu::CommandEncoder, vertices: &wgpu::Buffer) {
        let [samples, image] =
            [&self.samples, &self.image].map(|t| t.create_view(&Default::default()));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &samples,
                depth_slice: None,
                resolve_target: Some(&image),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::WHITE),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            ..Default::default()
        });
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.set_pipeline(&self.faces);
        pass.draw(0..3 * self.triangle_count, 0..1);
        pass.set_pipeline(&self.edges);
        pass.set_vertex_buffer(0, vertices.slice(..));
        pass.set_index_buffer(self.edge_indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..2 * self.edge_count, 0, 0..1);
    }

    /// Reads the pixels of the last drawing, row by row.
    pub(crate) fn read(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Vec<[u8; 4]>> {
        let pixels = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("pixels"),
            size: u64::from(4 * WIDTH * HEIGHT),
            usage: Usage::COPY_DST | Usage::COPY_SRC,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            // wgpu requires a multiple of 256 bytes.
            bytes_per_row: Some(4 * WIDTH),
            rows_per_image: None,
        };
        encoder.copy_texture_to_buffer(
            self.image.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &pixels, layout },
            self.image.size(),
        );
        queue.submit([encoder.finish()]);
        read(device, queue, &pixels)
    }
}

/// Returns each edge of the mesh once.
fn edges_of(mesh: &Mesh) -> Vec<[u32; 2]> {
    let of_triangle = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let ascending = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let mut edges: Vec<_> = mesh.triangles.iter().flat_map(of_triangle).map(ascending).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Returns the map to clip space that shows the whole mesh with a margin: `clip = xy * scale + offset`, as `[scale,
/// offset]`.
fn view_of(mesh: &Mesh) -> [[f32; 2]; 2] {
    let [x, y] = [0, 1].map(|axis| {
        let values = || mesh.points.iter().map(|point| point[axis]);
        [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)]
    });
    let (width, height) = (f64::from(WIDTH), f64::from(HEIGHT));
    let pixels = 0.96 * (width / (x[1] - x[0])).min(height / (y[1] - y[0]));
    let scale = [2.0 * pixels / width, 2.0 * pixels / height];
    let offset = [-scale[0] * (x[0] + x[1]) / 2.0, -scale[1] * (y[0] + y[1]) / 2.0];
    [scale, offset].map(|pair| pair.map(|x| x as f32))
}

/// Returns the pipeline for the vertex entry point `name` of mesh.wgsl.
fn pipeline(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    name: &str,
) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("mesh.wgsl"));
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("picture"),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    let lines = name == "edges";
    let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32];
    let vertex_buffers = [Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<Vertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &attributes,
    })];
    let (triangle_list, line_list) =
        (wgpu::PrimitiveTopology::TriangleList, wgpu::PrimitiveTopology::LineList);
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(name),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(name),
            compilation_options: Default::default(),
            buffers: if lines { &vertex_buffers } else { &[] },
        },
        primitive: wgpu::PrimitiveState {
            topology: if lines { line_list } else { triangle_list },
            ..Default::default()
        },
        depth_stencil: None,
        multisample: wgpu::MultisampleState { count: SAMPLES, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("color"),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: FORMAT,
                blend: Some(wgpu::BlendState::ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Copies a buffer to the host.
pub(crate) fn read<T: bytemuck::Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    buffer: &wgpu::Buffer,
) -> Result<Vec<T>> {
    let staging = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("staging"),
        size: buffer.size(),
        usage: Usage::COPY_DST | Usage::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
    queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    device.poll(wgpu::PollType::wait_indefinitely())?;
    let view = staging.get_mapped_range(..)?;
    Ok(bytemuck::pod_collect_to_vec(&view[..]))
}
