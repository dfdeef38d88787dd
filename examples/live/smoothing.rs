//! The mesh on the device: all that this application has to do with gpu-smooth.

use gpu_smooth::wgpu::{self, BufferUsages as Usage, util::DeviceExt};
use gpu_smooth::{
    BoundObjective, BoundVertices, DeviceMesh, Gpu, Mesh, Metric, ObjectiveValues, Options, Scheme,
    Sweeps, Topology, VertexBuffer, validity,
};
use std::sync::mpsc::{Receiver, channel};

use super::Result;

/// Bytes of a vertex: x and y, both f32.
const STRIDE: u64 = 8;

/// A mesh that is smoothed where it is drawn from, and the host's copy of it.
pub(crate) struct Smoothing {
    pub(crate) gpu: Gpu,
    pub(crate) mesh: Mesh,
    pub(crate) topology: Topology<'static>,
    /// The vertices that are drawn.
    pub(crate) vertices: wgpu::Buffer,
    /// The positions on the host, as the last frame left them.
    pub(crate) points: Vec<[f64; 2]>,
    /// How good the mesh is, as the last frame left it.
    pub(crate) objectives: ObjectiveValues,
    device_mesh: DeviceMesh,
    bound: BoundVertices,
    sweeps: Sweeps,
    objective: BoundObjective,
    scheme: Scheme,
    /// Whether the host has moved vertices since the last frame.
    moved: bool,
    objective_buffer: wgpu::Buffer,
    /// What the host reads after each frame: the vertices, then the objectives.
    staging: wgpu::Buffer,
    mapped: Option<Receiver<std::result::Result<(), wgpu::BufferAsyncError>>>,
}

impl Smoothing {
    pub(crate) fn new(gpu: Gpu, mesh: Mesh, scheme: Scheme) -> Result<Self> {
        let topology = Topology::new(&mesh)?.into_owned();
        let device_mesh = DeviceMesh::new(&gpu, &mesh)?;
        let sweeps = Sweeps::new(&device_mesh, &options(&scheme))?;
        // Every scheme that a key may choose, so that no frame waits for a compiler.
        Metric::ALL.iter().try_for_each(|&metric| gpu.prepare(&options(&metric.into())))?;
        let device = gpu.device();
        let points: Vec<_> = mesh.points.iter().map(|&p| rounded(p)).collect();
        let vertices = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("vertices"),
            contents: bytemuck::cast_slice(&floats(&points)),
            // STORAGE for the smoother, VERTEX and STORAGE for drawing.
            usage: Usage::VERTEX | Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST,
        });
        let buffer = |label, size, usage| {
            let label = Some(label);
            device.create_buffer(&wgpu::BufferDescriptor {
                label,
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let objective_bytes = size_of::<ObjectiveValues>() as u64;
        let objective_buffer =
            buffer("objectives", objective_bytes, Usage::STORAGE | Usage::COPY_SRC);
        let staging_bytes = vertices.size() + objective_bytes;
        let staging = buffer("staging", staging_bytes, Usage::MAP_READ | Usage::COPY_DST);
        let place = VertexBuffer::new(&vertices, STRIDE);
        let bound = device_mesh.bind_vertices(&place)?;
        let objective = sweeps.bind_objective(&objective_buffer, 0)?;
        Ok(Self {
            gpu,
            mesh,
            topology,
            vertices,
            points,
            objectives: ObjectiveValues::default(),
            device_mesh,
            bound,
            sweeps,
            objective,
            scheme,
            moved: false,
            objective_buffer,
            staging,
            mapped: None,
        })
    }

    pub(crate) fn scheme(&self) -> &Scheme {
        &self.scheme
    }

    /// Goes on with another scheme, from the vertices as they are.
    pub(crate) fn set_scheme(&mut self, scheme: Scheme) -> Result<()> {
        self.sweeps = Sweeps::new(&self.device_mesh, &options(&scheme))?;
        self.objective = self.sweeps.bind_objective(&self.objective_buffer, 0)?;
        self.scheme = scheme;
        Ok(())
    }

    /// Lets the sweeps move all vertices but these and those that the mesh itself fixes.
    pub(crate) fn hold(&mut self, held: &[u32]) -> Result<()> {
        self.device_mesh.set_pinned(held)?;
        self.sweeps.restart();
        Ok(())
    }

    /// Moves vertices on behalf of the user. Call it between [`receive`](Self::receive) and
    /// [`encode`](Self::encode), when the host's copy is what the device has.
    pub(crate) fn set_points(&mut self, points: Vec<[f64; 2]>) {
        self.points = points;
        self.moved = true;
        // All vertices are written: those that were not moved have the floats of the last export, and the import leaves
        // them alone.
        let bytes = floats(&self.points);
        self.gpu.queue().write_buffer(&self.vertices, 0, bytemuck::cast_slice(&bytes));
    }

    /// Moves all vertices back to where the mesh has them.
    pub(crate) fn reset(&mut self) {
        self.set_points(self.mesh.points.iter().map(|&p| rounded(p)).collect());
        self.sweeps.restart();
    }

    /// Encodes what a frame does before it draws: takes the user's moves, sweeps, and leaves the vertices
    /// where they are drawn from and where the host reads them.
    pub(crate) fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, sweeps: u32) {
        if std::mem::take(&mut self.moved) {
            self.bound.encode_import(encoder);
        }
        self.sweeps.encode_sweeps(encoder, sweeps);
        self.objective.encode_objective(encoder);
        self.bound.encode_export(encoder);
        let end = self.vertices.size();
        encoder.copy_buffer_to_buffer(&self.vertices, 0, &self.staging, 0, end);
        encoder.copy_buffer_to_buffer(&self.objective_buffer, 0, &self.staging, end, None);
    }

    /// To be called when what was encoded has been submitted.
    pub(crate) fn request(&mut self) {
        let (sender, receiver) = channel();
        // If the receiver is gone, nobody waits for the answer.
        let answer = move |result| drop(sender.send(result));
        self.staging.slice(..).map_async(wgpu::MapMode::Read, answer);
        self.mapped = Some(receiver);
    }

    /// Waits for the last frame and takes its vertices and objectives to the host: it must not move a
    /// vertex without knowing where its neighbors are.
    pub(crate) fn receive(&mut self) -> Result<()> {
        let Some(mapped) = self.mapped.take() else { return Ok(()) };
        self.gpu.device().poll(wgpu::PollType::wait_indefinitely())?;
        mapped.recv()??;
        {
            let bytes = self.staging.slice(..).get_mapped_range()?;
            let (points, objectives) = bytes.split_at(self.vertices.size() as usize);
            let points: Vec<[f32; 2]> = bytemuck::pod_collect_to_vec(points);
            self.points = points.iter().map(|p| p.map(f64::from)).collect();
            self.objectives = bytemuck::pod_read_unaligned(objectives);
        }
        self.staging.unmap();
        Ok(())
    }

    /// Counts the triangles that are inverted or flat, by exact arithmetic on the device's positions.
    pub(crate) fn count_infeasible(&self) -> Result<usize> {
        let points = self.device_mesh.read_points()?;
        Ok(validity::infeasible(&points, self.topology.triangles())?.len())
    }
}

fn options(scheme: &Scheme) -> Options {
    Options { scheme: scheme.clone(), ..Options::default() }
}

/// A point as the vertex buffer has it.
pub(crate) fn rounded(point: [f64; 2]) -> [f64; 2] {
    point.map(|x| f64::from(x as f32))
}

fn floats(points: &[[f64; 2]]) -> Vec<[f32; 2]> {
    points.iter().map(|p| p.map(|x| x as f32)).collect()
}
