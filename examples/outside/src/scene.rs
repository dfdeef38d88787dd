//! A mesh on the device with all bound resources, created and dropped together.

use gpu_smooth::{
    Gpu, GpuError, Mesh, Method, Options, Stopping,
    gpu::{
        BoundMove, BoundObjective, BoundVertices, Budget, DeviceMesh, ObjectiveValues, Readback,
        Sweeps, UntanglingSweeps, VertexBuffer,
    },
    wgpu::{self, BufferUsages as Usage},
};

use super::Result;

/// Vertex of the application: x, y and two numbers that the smoother ignores.
type Vertex = [f32; 4];
pub(crate) const STRIDE: u64 = size_of::<Vertex>() as u64;
/// Byte offset of a drag's completed fraction in the buffer of numbers. Objectives precede the fraction.
const SHARE: u64 = size_of::<ObjectiveValues>() as u64;

/// Largest inverse mean ratio that a drag may cause.
const WORST: f64 = 8.0;

pub(crate) struct Scene {
    gpu: Gpu,
    mesh: Mesh,
    pub(crate) device_mesh: DeviceMesh,
    bound: BoundVertices,
    sweeps: Sweeps,
    untangling: UntanglingSweeps,
    budget: Budget,
    objective: BoundObjective,
    vertices: wgpu::Buffer,
    numbers: wgpu::Buffer,
    targets: wgpu::Buffer,
    values: Readback<ObjectiveValues>,
    share: Readback<f32>,
    positions: Readback<Vertex>,
}

/// Results of a frame: sweep count, objectives, and the completed fraction of the drag.
pub(crate) struct Seen {
    pub(crate) sweeps: u32,
    pub(crate) values: ObjectiveValues,
    pub(crate) share: f32,
}

/// Returns the options of all sweeps. A correction from coarser levels follows each sweep. A frame then has time for
/// fewer sweeps, but a dragged mesh converges within a few frames.
pub(crate) fn options() -> Options {
    Options::default().method(Method::Multilevel).stopping(Stopping::Tolerance(1e-4))
}

impl Scene {
    /// Makes all resources of frames. Errors occur here, not in frames. Any thread may call this function.
    pub(crate) fn new(gpu: &Gpu, mesh: &Mesh) -> Result<Self> {
        let device_mesh = DeviceMesh::new(gpu, mesh)?;
        let buffer = |label, size, usage| {
            let (label, mapped_at_creation) = (Some(label), false);
            gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label,
                size,
                usage,
                mapped_at_creation,
            })
        };
        let count = mesh.points.len();
        let usage = Usage::VERTEX | Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST;
        let vertices = buffer("vertices", count as u64 * STRIDE, usage);
        let content: Vec<Vertex> =
            mesh.points.iter().map(|&[x, y]| [x as f32, y as f32, 1.0, 2.0]).collect();
        gpu.queue().write_buffer(&vertices, 0, bytemuck::cast_slice(&content));
        let numbers = buffer("numbers", SHARE + 4, Usage::STORAGE | Usage::COPY_SRC);
        let targets = buffer("targets", 8 * count as u64, Usage::STORAGE | Usage::COPY_DST);

        let bound = device_mesh.bind_vertices(&VertexBuffer::new(vertices.slice(..), STRIDE))?;
        let sweeps = Sweeps::until_converged(&device_mesh, &options()).block()?;
        let untangling = UntanglingSweeps::new(&device_mesh)?;
        let objective = sweeps.bind_objective(numbers.slice(..))?;
        let budget = Budget::micros(2000).at_most(20);
        let budget = match gpu.device().features().contains(Gpu::optional_features()) {
            true => budget.timed_by(gpu)?,
            false => budget,
        };
        Ok(Self {
            gpu: gpu.clone(),
            mesh: mesh.clone(),
            bound,
            sweeps,
            untangling,
            budget,
            objective,
            values: Readback::new(gpu, numbers.slice(..), 1)?,
            share: Readback::new(gpu, numbers.slice(SHARE..), 1)?,
            positions: Readback::new(gpu, vertices.slice(..), count)?,
            vertices,
            numbers,
            targets,
            device_mesh,
        })
    }

    /// Executes a frame: imports vertices, moves dragged vertices, untangles, sweeps within the budget, and exports the
    /// vertices.
    pub(crate) fn frame(&mut self, drag: Option<(&BoundMove, &[[f32; 2]])>) -> Result<Seen> {
        let (device, queue) = (self.gpu.device(), self.gpu.queue());
        let mut encoder = device.create_command_encoder(&Default::default());
        self.bound.encode_import(&mut encoder);
        if let Some((drag, targets)) = drag {
            queue.write_buffer(&self.targets, 0, bytemuck::cast_slice(targets));
            drag.encode_move(&mut encoder);
        }
        self.untangling.encode_untangle(&mut encoder, 3);
        let sweeps = self.sweeps.encode_within(&mut encoder, &mut self.budget);
        {
            // A compute pass of the application, which may contain further kernels.
            let mut pass = encoder.begin_compute_pass(&Default::default());
            self.objective.encode_objective(&mut pass);
            self.bound.encode_export(&mut pass);
        }
        // An application would encode its drawing here.
        self.values.encode_readback(&mut encoder);
        if drag.is_some() {
            self.share.encode_readback(&mut encoder);
        }
        self.positions.encode_readback(&mut encoder);
        queue.submit([encoder.finish()]);
        // This example waits for the device. An application with a window would continue with the next frame.
        let _ = device.poll(wgpu::PollType::wait_indefinitely());

        let values = self.values.latest()?.map_or_else(Default::default, |values| values[0]);
        let share = self.share.latest()?.map_or(1.0, |share| share[0]);
        Ok(Seen { sweeps, values, share: if drag.is_some() { share } else { 1.0 } })
    }

    /// Evaluates the vertices that the application has written, without sweeps.
    pub(crate) fn look(&mut self) -> Result<Seen> {
        let (device, queue) = (self.gpu.device(), self.gpu.queue());
        let mut encoder = device.create_command_encoder(&Default::default());
        self.bound.encode_import(&mut encoder);
        self.objective.encode_objective(&mut encoder);
        self.values.encode_readback(&mut encoder);
        queue.submit([encoder.finish()]);
        let _ = device.poll(wgpu::PollType::wait_indefinitely());
        let values = self.values.latest()?.map_or_else(Default::default, |values| values[0]);
        Ok(Seen { sweeps: 0, values, share: 1.0 })
    }

    /// Writes positions to the vertex buffer, even if they invert triangles.
    pub(crate) fn write(&self, vertices: &[u32], to: &[[f32; 2]]) {
        for (&v, place) in vertices.iter().zip(to) {
            let at = u64::from(v) * STRIDE;
            self.gpu.queue().write_buffer(&self.vertices, at, bytemuck::bytes_of(place));
        }
    }

    /// Binds a move of `vertices` for a drag.
    pub(crate) fn take_hold(&self, vertices: &[u32]) -> Result<BoundMove> {
        let targets = VertexBuffer::new(self.targets.slice(..), 8);
        Ok(self.device_mesh.bind_move(vertices, &targets, WORST, self.numbers.slice(SHARE..))?)
    }

    /// Returns the original positions of some vertices, as given by the mesh.
    pub(crate) fn home(&self, vertices: &[u32]) -> Vec<[f32; 2]> {
        vertices.iter().map(|&v| self.mesh.points[v as usize].map(|x| x as f32)).collect()
    }

    /// Returns the positions of some vertices in the latest frame read back.
    pub(crate) fn places(&mut self, vertices: &[u32]) -> Result<Vec<[f32; 2]>> {
        let positions = self.positions.latest()?.ok_or("no frame has arrived")?;
        Ok(vertices.iter().map(|&v| positions[v as usize]).map(|[x, y, ..]| [x, y]).collect())
    }

    /// Returns the mesh with the vertices of the latest frame read back.
    pub(crate) fn last_mesh(&mut self) -> std::result::Result<Mesh, GpuError> {
        let mut mesh = self.mesh.clone();
        if let Some(positions) = self.positions.latest()? {
            mesh.points = positions.iter().map(|&[x, y, ..]| [x.into(), y.into()]).collect();
        }
        Ok(mesh)
    }
}
