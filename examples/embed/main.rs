//! Smooths a mesh inside an application, on the vertex buffer that the application draws from:
//!
//! ```text
//! cargo run --release --example embed -- [MESH] [OUT_DIR]
//! ```
//!
//! Writes before.png and after.png. For after.png, one command buffer contains the sweeps and the drawing, and no
//! vertex passes through the host. `picture.rs` is plain wgpu, which an application has anyway.
#![allow(clippy::print_stdout)]

mod picture;

use std::path::{Path, PathBuf};

use gpu_smooth::{
    Gpu, Mesh, Metric, Options,
    gpu::{DeviceMesh, ObjectiveValues, Sweeps, VertexBuffer},
    wgpu,
};
use gpu_smooth_job::Job;
use mesh_io::MeshFile;
use picture::Picture;
use wgpu::BufferUsages as Usage;
use wgpu::util::DeviceExt;

pub(crate) type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Vertex of the application: x, y, z, and the darkness of edges. The smoother reads and writes only x and y.
pub(crate) type Vertex = [f32; 4];

/// The mesh of a command line without MESH. The path is absolute, so that the example runs in any directory.
pub(crate) const DEFAULT_MESH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../meshes/plate.node");

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1).map(PathBuf::from);
    let mesh = args.next().unwrap_or(DEFAULT_MESH.into());
    let out = args.next().unwrap_or(".".into());

    let file = MeshFile::read(&mesh)?;
    // Vertices that the file constrains, and vertices between its regions, are fixed.
    let job = Job::of_file(&file)?;
    let [before, after] = smooth_and_draw(job.mesh(), 5)?;
    for (name, frame) in [("before.png", before), ("after.png", after)] {
        frame.write(&out.join(name))?;
        let ObjectiveValues { worst_imr, inverted, .. } = frame.quality;
        let f = frame.quality.of(Metric::Imr);
        println!("{name}: f_imr {f:.4}, worst {worst_imr:.2}, {inverted} inverted");
    }
    Ok(())
}

/// A picture of the mesh, with the quality of the drawn mesh.
pub(crate) struct Frame {
    pub(crate) pixels: Vec<[u8; 4]>,
    pub(crate) quality: ObjectiveValues,
}

impl Frame {
    pub(crate) fn write(&self, path: &Path) -> Result<()> {
        let file = std::io::BufWriter::new(std::fs::File::create(path)?);
        let mut encoder = png::Encoder::new(file, picture::WIDTH, picture::HEIGHT);
        encoder.set_color(png::ColorType::Rgba);
        Ok(encoder.write_header()?.write_image_data(self.pixels.as_flattened())?)
    }
}

/// Draws the mesh in one frame without sweeps, and in a second frame after `sweeps` sweeps.
pub(crate) fn smooth_and_draw(mesh: &Mesh, sweeps: u32) -> Result<[Frame; 2]> {
    let (device, queue) = open_device(mesh)?;

    // Resources of the application: a vertex buffer, and a picture that is drawn from the buffer. The smoother requires
    // the buffer usage STORAGE.
    let vertices = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("vertices"),
        contents: bytemuck::cast_slice(&vertices_of(mesh)),
        usage: Usage::VERTEX | Usage::STORAGE,
    });
    let picture = Picture::new(&device, mesh, &vertices);
    let objectives = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("objectives"),
        size: size_of::<ObjectiveValues>() as u64,
        usage: Usage::STORAGE | Usage::COPY_SRC,
        mapped_at_creation: false,
    });

    // Resources of the smoother, made once and bound to the vertex buffer and the buffer for objectives. Clones of the
    // device and the queue are handles to shared objects.
    let gpu = Gpu::new(device.clone(), queue.clone())?;
    let device_mesh = DeviceMesh::new(&gpu, mesh)?;
    let mut smoother = Sweeps::new(&device_mesh, &Options::default()).block()?;
    let stride = size_of::<Vertex>() as u64;
    let bound = device_mesh.bind_vertices(&VertexBuffer::new(vertices.slice(..), stride))?;
    let objective = smoother.bind_objective(objectives.slice(..))?;

    let mut frame = |sweeps| -> Result<Frame> {
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if sweeps > 0 {
            // The import reads vertices that the application has moved since the last export. No vertex has moved here,
            // so the import could be omitted.
            bound.encode_import(&mut encoder);
            smoother.encode_sweeps(&mut encoder, sweeps);
            bound.encode_export(&mut encoder);
        }
        objective.encode_objective(&mut encoder);
        picture.draw(&mut encoder, &vertices);
        queue.submit([encoder.finish()]);

        // The pixels are read only for the file and the printed numbers; an application with a window would not read
        // them.
        let pixels = picture.read(&device, &queue)?;
        let quality: Vec<ObjectiveValues> = picture::read(&device, &queue, &objectives)?;
        Ok(Frame { pixels, quality: quality[0] })
    };
    Ok([frame(0)?, frame(sweeps)?])
}

/// Opens a device with the limits that smoother and application need.
fn open_device(mesh: &Mesh) -> Result<(wgpu::Device, wgpu::Queue)> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&Default::default()))?;
    let size = mesh.size();
    let application_needs = wgpu::Limits::default();
    let device = adapter.request_device(&wgpu::DeviceDescriptor {
        label: Some("application"),
        required_features: Gpu::required_features(),
        required_limits: Gpu::required_limits(application_needs, size, &adapter.limits())?,
        ..Default::default()
    });
    Ok(pollster::block_on(device)?)
}

fn vertices_of(mesh: &Mesh) -> Vec<Vertex> {
    // Edges are pale, because black edges would hide small triangles.
    mesh.points.iter().map(|&[x, y]| [x as f32, y as f32, 0.0, 0.45]).collect()
}
