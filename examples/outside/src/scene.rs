//! A mesh on the device with all that is bound to it: made when a mesh comes, dropped when it goes.

use gpu_smooth::wgpu::{self, BufferUsages as Usage};
use gpu_smooth::{
    BoundMove, BoundObjective, BoundVertices, Budget, DeviceMesh, Gpu, GpuError, Mesh, Method,
    ObjectiveValues, Options, Readback, Sweeps, UntanglingSweeps, VertexBuffer,
};

use super::Result;

/// What the application keeps of each vertex: x, y and two numbers of its own.
type Vertex = [f32; 4];
pub(crate) const STRIDE: u64 = size_of::<Vertex>() as u64;
/// Where the share of a drag stands in the buffer of numbers, after the objectives.
const SHARE: u64 = size_of::<ObjectiveValues>() as u64;

/// A triangle gets no worse than this in a drag.
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

/// What a frame shows of itself and of those before.
pub(crate) struct Seen {
    pub(crate) sweeps: u32,
    pub(crate) values: ObjectiveValues,
    pub(crate) share: f32,
}

/// How the mesh is smoothed: each sweep is followed by a correction from coarser levels, so that a frame has fewer of them, but a mesh
/// that was dragged is at rest again after a few.
pub(crate) fn options() -> Options {
    Options { method: Method::Multilevel, tolerance: 1e-4, ..Options::default() }
}

impl Scene {
    /// Makes all that frames need; what can fail, fails here. It may be called on another thread than that of the frames.
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

        let bound = device_mesh.bind_vertices(&VertexBuffer::new(&vertices, STRIDE))?;
        let sweeps = Sweeps::until_converged(&device_mesh, &options())?;
        let untangling = UntanglingSweeps::new(&device_mesh)?;
        let objective = sweeps.bind_objective(&numbers, 0)?;
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
            values: Readback::new(gpu, &numbers, 0, 1)?,
            share: Readback::new(gpu, &numbers, SHARE, 1)?,
            positions: Readback::new(gpu, &vertices, 0, count)?,
            vertices,
            numbers,
            targets,
            device_mesh,
        })
    }

    /// One frame: takes vertices that were written, moves what the user drags, turns triangles back that are inverted, sweeps as long as there is time, and leaves the vertices where they are drawn.
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
            // A pass of the application: it may have kernels of its own before and after.
            let mut pass = encoder.begin_compute_pass(&Default::default());
            self.objective.encode_objective(&mut pass);
            self.bound.encode_export(&mut pass);
        }
        // Here the application draws.
        self.values.encode_readback(&mut encoder);
        if drag.is_some() {
            self.share.encode_readback(&mut encoder);
        }
        self.positions.encode_readback(&mut encoder);
        queue.submit([encoder.finish()]);
        // A window has a frame in 16 milliseconds; this waits as long as the device needs.
        let _ = device.poll(wgpu::PollType::wait_indefinitely());

        let values = self.values.latest()?.map_or_else(Default::default, |values| values[0]);
        let share = self.share.latest()?.map_or(1.0, |share| share[0]);
        Ok(Seen { sweeps, values, share: if drag.is_some() { share } else { 1.0 } })
    }

    /// How the mesh is with the vertices as the application has them, before any sweep.
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

    /// Writes vertices of the application: they go there whatever becomes of the triangles.
    pub(crate) fn write(&self, vertices: &[u32], to: &[[f32; 2]]) {
        for (&v, place) in vertices.iter().zip(to) {
            let at = u64::from(v) * STRIDE;
            self.gpu.queue().write_buffer(&self.vertices, at, bytemuck::bytes_of(place));
        }
    }

    /// Lets the user move vertices.
    pub(crate) fn take_hold(&self, vertices: &[u32]) -> Result<BoundMove> {
        let targets = VertexBuffer::new(&self.targets, 8);
        Ok(self.device_mesh.bind_move(vertices, &targets, WORST, (&self.numbers, SHARE))?)
    }

    /// Where the mesh had these vertices at first.
    pub(crate) fn home(&self, vertices: &[u32]) -> Vec<[f32; 2]> {
        vertices.iter().map(|&v| self.mesh.points[v as usize].map(|x| x as f32)).collect()
    }

    /// Where the last frame that was read back had them.
    pub(crate) fn places(&mut self, vertices: &[u32]) -> Result<Vec<[f32; 2]>> {
        let positions = self.positions.latest()?.ok_or("no frame has arrived")?;
        Ok(vertices.iter().map(|&v| positions[v as usize]).map(|[x, y, ..]| [x, y]).collect())
    }

    /// The mesh with the vertices of the last frame that was read back.
    pub(crate) fn last_mesh(&mut self) -> std::result::Result<Mesh, GpuError> {
        let mut mesh = self.mesh.clone();
        if let Some(positions) = self.positions.latest()? {
            mesh.points = positions.iter().map(|&[x, y, ..]| [x.into(), y.into()]).collect();
        }
        Ok(mesh)
    }
}
