//! Drawing of triangles by quality, of edges, held vertices and the panel.

use gpu_smooth::{
    Topology,
    wgpu::{self, BufferUsages as Usage, util::DeviceExt},
};

use super::overlay::{self, Panel};
use super::view::View;

/// Gray, linear, and darker than the palest color of triangles, from which it must differ.
const BACKGROUND: wgpu::Color = wgpu::Color { r: 0.42, g: 0.42, b: 0.41, a: 1.0 };

/// Render pipelines, and their buffers other than the vertex buffer.
pub(crate) struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// Format of the target texture.
    pub(crate) format: wgpu::TextureFormat,
    /// The pipelines of triangles, edges, marks and the panel.
    pipelines: [(wgpu::RenderPipeline, wgpu::BindGroup); 4],
    uniform: wgpu::Buffer,
    vertices: wgpu::Buffer,
    edge_indices: wgpu::Buffer,
    corners: u32,
    marked: (wgpu::Buffer, u32),
    panel_texture: wgpu::Texture,
}

impl Renderer {
    pub(crate) fn new(
        (device, queue): (wgpu::Device, wgpu::Queue),
        format: wgpu::TextureFormat,
        topology: &Topology<'_>,
        vertices: wgpu::Buffer,
        panel: &Panel,
    ) -> Self {
        let shader = device.create_shader_module(wgpu::include_wgsl!("draw.wgsl"));
        let filled = |label, contents: &[u8], usage| {
            let label = Some(label);
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label, contents, usage })
        };
        let uniform = filled("view", &[0; size_of::<Uniform>()], Usage::UNIFORM | Usage::COPY_DST);
        let triangles =
            filled("triangles", bytemuck::cast_slice(topology.triangles()), Usage::STORAGE);
        let edges = edges(topology);
        let edge_indices = filled("edges", bytemuck::cast_slice(&edges), Usage::INDEX);
        let marked = filled("marks", &[0; 4], Usage::VERTEX);
        let panel_texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("panel"),
            size: extent(panel.size()),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8UnormSrgb,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let panel_view = panel_texture.create_view(&Default::default());

        use wgpu::VertexStepMode::{Instance, Vertex};
        let layout = |array_stride, step_mode, attributes| {
            Some(wgpu::VertexBufferLayout { array_stride, step_mode, attributes })
        };
        let per_vertex = layout(8, Vertex, &wgpu::vertex_attr_array![0 => Float32x2]);
        let per_mark = layout(4, Instance, &wgpu::vertex_attr_array![0 => Uint32]);
        use wgpu::PrimitiveTopology::{LineList, TriangleList};
        let view = (0, uniform.as_entire_binding());
        let triangles = (1, triangles.as_entire_binding());
        let points = (2, vertices.as_entire_binding());
        let picture = (3, wgpu::BindingResource::TextureView(&panel_view));
        let make = |name, primitive, buffer, resources: &[_]| {
            let pipeline = pipeline(&device, &shader, format, name, primitive, buffer);
            let bind_group = bind(&device, &pipeline, resources);
            (pipeline, bind_group)
        };
        let pipelines = [
            make("fill", TriangleList, None, &[view.clone(), triangles, points.clone()]),
            make("edge", LineList, per_vertex, std::slice::from_ref(&view)),
            make("mark", TriangleList, per_mark, &[view.clone(), points]),
            make("panel", TriangleList, None, &[view, picture]),
        ];
        Self {
            pipelines,
            uniform,
            vertices,
            corners: 3 * topology.triangles().len() as u32,
            edge_indices,
            marked: (marked, 0),
            panel_texture,
            format,
            device,
            queue,
        }
    }

    /// Sets the view of the mesh, and the enlargement of the panel's pixels.
    pub(crate) fn show(&self, view: View, enlargement: u32) {
        let [scale, offset, pixel] = view.uniform();
        let stops = overlay::STOPS.map(|[r, g, b]| [r, g, b, 255].map(|x| f32::from(x) / 255.0));
        let uniform =
            Uniform { scale, offset, pixel, enlargement: enlargement as f32, padding: 0.0, stops };
        self.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
    }

    /// Marks `vertices` as held.
    pub(crate) fn mark(&mut self, vertices: &[u32]) {
        if !vertices.is_empty() {
            self.marked.0 = self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("marks"),
                contents: bytemuck::cast_slice(vertices),
                usage: Usage::VERTEX,
            });
        }
        self.marked.1 = vertices.len() as u32;
    }

    pub(crate) fn set_panel(&self, panel: &Panel) {
        let [width, height] = panel.size();
        self.queue.write_texture(
            self.panel_texture.as_image_copy(),
            panel.pixels(),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * width),
                rows_per_image: Some(height),
            },
            self.panel_texture.size(),
        );
    }

    pub(crate) fn draw(&self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("mesh"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(BACKGROUND),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        let [fill, edges, marks, panel] = &self.pipelines;
        let set = |pass: &mut wgpu::RenderPass<'_>, (pipeline, bind_group): &(_, _)| {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, bind_group, &[]);
        };
        set(&mut pass, fill);
        pass.draw(0..self.corners, 0..1);

        set(&mut pass, edges);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.edge_indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..(self.edge_indices.size() / 4) as u32, 0, 0..1);

        set(&mut pass, marks);
        pass.set_vertex_buffer(0, self.marked.0.slice(..));
        pass.draw(0..6, 0..self.marked.1);

        set(&mut pass, panel);
        pass.draw(0..6, 0..1);
    }
}

/// The uniform `View` of draw.wgsl.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Uniform {
    scale: [f32; 2],
    offset: [f32; 2],
    pixel: [f32; 2],
    enlargement: f32,
    padding: f32,
    stops: [[f32; 4]; 7],
}

/// Returns each edge of the mesh once.
fn edges(topology: &Topology<'_>) -> Vec<[u32; 2]> {
    let of = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]].map(|[v, w]| [v.min(w), v.max(w)]);
    let mut edges: Vec<_> = topology.triangles().iter().flat_map(of).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

pub(crate) fn extent([width, height]: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width, height, depth_or_array_layers: 1 }
}

fn pipeline(
    device: &wgpu::Device,
    shader: &wgpu::ShaderModule,
    format: wgpu::TextureFormat,
    name: &str,
    topology: wgpu::PrimitiveTopology,
    buffer: Option<wgpu::VertexBufferLayout<'_>>,
) -> wgpu::RenderPipeline {
    let buffers: Vec<_> = buffer.into_iter().map(Some).collect();
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(name),
        layout: None,
        vertex: wgpu::VertexState {
            module: shader,
            entry_point: Some(&format!("{name}_vertex")),
            compilation_options: Default::default(),
            buffers: &buffers,
        },
        primitive: wgpu::PrimitiveState { topology, ..Default::default() },
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: shader,
            entry_point: Some(&format!("{name}_fragment")),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format,
                blend: (name == "edge").then_some(wgpu::BlendState::ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn bind(
    device: &wgpu::Device,
    pipeline: &wgpu::RenderPipeline,
    resources: &[(u32, wgpu::BindingResource<'_>)],
) -> wgpu::BindGroup {
    let entries = resources.iter().cloned();
    let entries: Vec<_> =
        entries.map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    })
}
