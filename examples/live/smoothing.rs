//! The mesh on the device: all that this application has to do with gpu-smooth.

use gpu_smooth::wgpu::{self, BufferUsages as Usage, util::DeviceExt};
use gpu_smooth::{
    DeviceMesh, Gpu, Mesh, Metric, Options, Scheme, Sweeps, Topology, VertexBuffer, validity,
};
use std::sync::mpsc::{Receiver, channel};

use super::Result;

/// Bytes of a vertex: x and y, both f32.
const STRIDE: u64 = 8;
const OBJECTIVES: usize = Sweeps::OBJECTIVE_FLOATS;

/// A mesh that is smoothed where it is drawn from, and the host's copy of it.
pub(crate) struct Smoothing {
    pub(crate) gpu: Gpu,
    pub(crate) mesh: Mesh,
    pub(crate) topology: Topology,
    /// The vertices that are drawn.
    pub(crate) vertices: wgpu::Buffer,
    /// The same on the host, as the last frame left them.
    pub(crate) points: Vec<[f64; 2]>,
    /// f by each metric, then the number of inverted triangles, as the last frame left them.
    objectives: [f32; OBJECTIVES],
    device_mesh: DeviceMesh,
    sweeps: Sweeps,
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
        let topology = Topology::new(&mesh)?;
        let device_mesh = DeviceMesh::new(&gpu, &mesh)?;
        let sweeps = Sweeps::new(&gpu, &device_mesh, &options(&scheme))?;
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
        let objective_bytes = (OBJECTIVES * size_of::<f32>()) as u64;
        let objective_buffer =
            buffer("objectives", objective_bytes, Usage::STORAGE | Usage::COPY_SRC);
        let staging_bytes = vertices.size() + objective_bytes;
        let staging = buffer("staging", staging_bytes, Usage::MAP_READ | Usage::COPY_DST);
        Ok(Self {
            gpu,
            mesh,
            topology,
            vertices,
            points,
            objectives: [f32::NAN; OBJECTIVES],
            device_mesh,
            sweeps,
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
        self.sweeps = Sweeps::new(&self.gpu, &self.device_mesh, &options(&scheme))?;
        self.scheme = scheme;
        Ok(())
    }

    /// Lets the sweeps move all vertices but these and those that the mesh itself fixes.
    pub(crate) fn hold(&mut self, held: &[u32]) -> Result<()> {
        let mut fixed = vec![false; self.points.len()];
        for &v in self.mesh.fixed.iter().chain(held) {
            fixed[v as usize] = true;
        }
        self.device_mesh.set_fixed(&self.gpu, &fixed)?;
        self.sweeps.restart();
        Ok(())
    }

    /// Moves vertices on behalf of the user. Call it between [`receive`](Self::receive) and
    /// [`encode`](Self::encode), when the host's copy is what the device has.
    pub(crate) fn set_points(&mut self, points: Vec<[f64; 2]>) {
        self.points = points;
        self.moved = true;
        // All of them: those that were not moved have the floats of the last export, and the import
        // leaves them alone.
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
    pub(crate) fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, sweeps: u32) -> Result<()> {
        let buffer = VertexBuffer { buffer: &self.vertices, offset: 0, stride: STRIDE };
        if std::mem::take(&mut self.moved) {
            self.device_mesh.encode_import(&self.gpu, encoder, &buffer)?;
        }
        self.sweeps.encode(encoder, sweeps);
        self.sweeps.encode_objective(&self.gpu, encoder, &self.objective_buffer, 0)?;
        self.device_mesh.encode_export(&self.gpu, encoder, &buffer)?;
        let end = self.vertices.size();
        encoder.copy_buffer_to_buffer(&self.vertices, 0, &self.staging, 0, end);
        encoder.copy_buffer_to_buffer(&self.objective_buffer, 0, &self.staging, end, None);
        Ok(())
    }

    /// To be called when what was encoded has been submitted.
    pub(crate) fn request(&mut self) {
        let (sender, receiver) = channel();
        // A receiver that is gone wants no answer.
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
        let floats: Vec<f32> = {
            let bytes = self.staging.slice(..).get_mapped_range()?;
            bytemuck::pod_collect_to_vec(&bytes)
        };
        self.staging.unmap();
        let (points, objectives) = floats.split_at(2 * self.points.len());
        let (points, _) = points.as_chunks::<2>();
        self.points = points.iter().map(|p| p.map(f64::from)).collect();
        self.objectives.copy_from_slice(objectives);
        Ok(())
    }

    /// f by the base metric, after the last frame.
    pub(crate) fn objective(&self) -> f32 {
        self.objectives[self.scheme.base() as usize]
    }

    /// Triangles inverted or flat in single precision, after the last frame.
    pub(crate) fn inverted(&self) -> usize {
        self.objectives[Metric::ALL.len()] as usize
    }

    /// Counts the triangles that are inverted or flat, by exact arithmetic on the device's positions.
    pub(crate) fn count_infeasible(&self) -> Result<usize> {
        let points = self.device_mesh.read_points(&self.gpu, &self.mesh)?;
        Ok(validity::infeasible(&points, self.topology.triangles()).len())
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
