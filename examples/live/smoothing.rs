//! The mesh on the device: everything in this application that uses gpu-smooth.

use gpu_smooth::{
    Gpu, Mesh, Metric, Options, Scheme, Stopping, Topology,
    gpu::{
        BoundMove, BoundObjective, BoundVertices, Budget, DeviceMesh, ObjectiveValues, Readback,
        Sweeps, UntanglingSweeps, VertexBuffer,
    },
    topology,
    wgpu::{self, BufferUsages as Usage, util::DeviceExt},
};

use super::Result;

/// Bytes of a vertex: x and y, both f32.
const STRIDE: u64 = 8;
/// The offset of the share of a move in the buffer of numbers, in bytes. Objectives come before it.
const SHARE: u64 = size_of::<ObjectiveValues>() as u64;
/// The largest inverse mean ratio that a drag gives a triangle; one that is worse already may stay as bad.
const WORST: f64 = 8.0;
/// The number of untangling sweeps in each frame. They do nothing while nothing is inverted.
const UNTANGLING: u32 = 5;
/// The most sweeps in a frame; `WITHOUT_CLOCK` is their number on a device without timestamps.
const MOST: u32 = 16;
const WITHOUT_CLOCK: u32 = 4;

/// A mesh that is smoothed in the buffer it is drawn from. The host sees earlier frames as they arrive, and never waits.
pub(crate) struct Smoothing {
    pub(crate) gpu: Gpu,
    pub(crate) mesh: Mesh,
    pub(crate) topology: Topology<'static>,
    /// The vertices that are drawn.
    pub(crate) vertices: wgpu::Buffer,
    /// The positions of the last frame that has arrived.
    pub(crate) points: Vec<[f64; 2]>,
    /// The objectives of the last frame that has arrived.
    pub(crate) objectives: ObjectiveValues,
    device_mesh: DeviceMesh,
    bound: BoundVertices,
    sweeps: Sweeps,
    untangling: UntanglingSweeps,
    objective: BoundObjective,
    scheme: Scheme,
    budget: Budget,
    has_clock: bool,
    /// The move of what the user holds, if it is to stop before a triangle inverts.
    held: Option<BoundMove>,
    targets: wgpu::Buffer,
    numbers: wgpu::Buffer,
    /// Whether the host has written vertices since the last frame.
    moved: bool,
    seen_points: Readback<[f32; 2]>,
    seen_objectives: Readback<ObjectiveValues>,
}

impl Smoothing {
    pub(crate) fn new(gpu: Gpu, mesh: Mesh, scheme: Scheme) -> Result<Self> {
        let topology = Topology::new(&mesh)?.into_owned();
        let device_mesh = DeviceMesh::new(&gpu, &mesh)?;
        let sweeps = Sweeps::until_converged(&device_mesh, &options(&scheme))?;
        let untangling = UntanglingSweeps::new(&device_mesh)?;
        // Compiles the kernels of every scheme that a key may choose, so that no frame waits for a compiler.
        Metric::ALL.iter().try_for_each(|&metric| gpu.prepare(&options(&metric.into())))?;
        let device = gpu.device();
        let vertices = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("vertices"),
            contents: bytemuck::cast_slice(&floats(&mesh.points)),
            // The smoother needs STORAGE, drawing needs VERTEX and STORAGE.
            usage: Usage::VERTEX | Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST,
        });
        let buffer = |label, size, usage| {
            let (label, mapped_at_creation) = (Some(label), false);
            device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation })
        };
        let numbers = buffer("numbers", SHARE + 4, Usage::STORAGE | Usage::COPY_SRC);
        let targets = buffer("targets", vertices.size(), Usage::STORAGE | Usage::COPY_DST);
        let bound = device_mesh.bind_vertices(&VertexBuffer::new(&vertices, STRIDE))?;
        let objective = sweeps.bind_objective(&numbers, 0)?;
        let has_clock = device.features().contains(Gpu::optional_features());
        let mut smoothing = Self {
            seen_points: Readback::new(&gpu, &vertices, 0, mesh.points.len())?,
            seen_objectives: Readback::new(&gpu, &numbers, 0, 1)?,
            points: mesh.points.clone(),
            objectives: ObjectiveValues::default(),
            gpu,
            mesh,
            topology,
            vertices,
            device_mesh,
            bound,
            sweeps,
            untangling,
            objective,
            scheme,
            budget: Budget::micros(0),
            has_clock,
            held: None,
            targets,
            numbers,
            moved: false,
        };
        smoothing.set_budget(2000)?;
        Ok(smoothing)
    }

    pub(crate) fn scheme(&self) -> &Scheme {
        &self.scheme
    }

    /// Continues with another scheme, from the present vertices.
    pub(crate) fn set_scheme(&mut self, scheme: Scheme) -> Result<()> {
        self.sweeps = Sweeps::until_converged(&self.device_mesh, &options(&scheme))?;
        self.objective = self.sweeps.bind_objective(&self.numbers, 0)?;
        self.scheme = scheme;
        Ok(())
    }

    /// Sets the time for sweeps in each frame. A device without timestamps does the same number of sweeps in each frame.
    pub(crate) fn set_budget(&mut self, micros: u64) -> Result<()> {
        let budget = Budget::micros(micros).at_most(MOST);
        self.budget = if self.has_clock { budget.timed_by(&self.gpu)? } else { budget };
        Ok(())
    }

    /// Pins the vertices that the user has grabbed, and no others. With `clamp` the device moves them, as far as the triangles
    /// allow.
    pub(crate) fn hold(&mut self, held: &[u32], clamp: bool) -> Result<()> {
        self.device_mesh.set_pinned(held)?;
        let targets = VertexBuffer::new(&self.targets, STRIDE);
        let bind = || self.device_mesh.bind_move(held, &targets, WORST, (&self.numbers, SHARE));
        self.held = (clamp && !held.is_empty()).then(bind).transpose()?;
        Ok(())
    }

    /// Sets where the held vertices go in the next frame.
    pub(crate) fn aim(&mut self, held: &[u32], goals: &[[f64; 2]]) {
        let (queue, goals) = (self.gpu.queue(), floats(goals));
        if self.held.is_some() {
            queue.write_buffer(&self.targets, 0, bytemuck::cast_slice(&goals));
            return;
        }
        // Writes into the vertex buffer. All other vertices still have the floats of the last export, so the import ignores them.
        for (&v, goal) in held.iter().zip(&goals) {
            queue.write_buffer(&self.vertices, u64::from(v) * STRIDE, bytemuck::bytes_of(goal));
        }
        self.moved = true;
    }

    /// Moves all vertices back to their places in the mesh file.
    pub(crate) fn reset(&mut self) {
        let floats = floats(&self.mesh.points);
        self.gpu.queue().write_buffer(&self.vertices, 0, bytemuck::cast_slice(&floats));
        self.moved = true;
        self.sweeps.restart();
    }

    /// Encodes what a frame does before it draws: moves what the user holds, turns inverted triangles back, sweeps while there is
    /// time, and exports the vertices to be drawn. Returns the number of sweeps.
    pub(crate) fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, paused: bool) -> u32 {
        if std::mem::take(&mut self.moved) {
            self.bound.encode_import(encoder);
        }
        if let Some(held) = &self.held {
            held.encode_move(encoder);
        }
        let sweeps = match (paused, self.has_clock) {
            (true, _) => 0,
            (false, true) => {
                self.untangling.encode_untangle(encoder, UNTANGLING);
                self.sweeps.encode_within(encoder, &mut self.budget)
            }
            (false, false) => {
                self.untangling.encode_untangle(encoder, UNTANGLING);
                self.sweeps.encode_sweeps(encoder, WITHOUT_CLOCK);
                WITHOUT_CLOCK
            }
        };
        self.objective.encode_objective(encoder);
        self.bound.encode_export(encoder);
        self.seen_points.encode_readback(encoder);
        self.seen_objectives.encode_readback(encoder);
        sweeps
    }

    /// Takes the results of earlier frames that have arrived.
    pub(crate) fn receive(&mut self) -> Result<()> {
        self.gpu.device().poll(wgpu::PollType::Poll)?;
        if let Some(points) = self.seen_points.latest()? {
            self.points.clear();
            self.points.extend(points.iter().map(|p| p.map(f64::from)));
        }
        if let Some(&[objectives]) = self.seen_objectives.latest()? {
            self.objectives = objectives;
        }
        Ok(())
    }

    /// Waits for the last frame, where there is no window whose frames to wait for.
    pub(crate) fn wait(&mut self) -> Result<()> {
        self.gpu.device().poll(wgpu::PollType::wait_indefinitely())?;
        self.receive()
    }

    /// Counts the triangles that are inverted or flat, by exact arithmetic on the device's positions.
    pub(crate) fn count_infeasible(&self) -> Result<usize> {
        let points = self.device_mesh.read_points()?;
        Ok(topology::infeasible(&points, self.topology.triangles())?.len())
    }
}

fn options(scheme: &Scheme) -> Options {
    Options { scheme: scheme.clone(), stopping: Stopping::Tolerance(1e-4), ..Options::default() }
}

fn floats(points: &[[f64; 2]]) -> Vec<[f32; 2]> {
    points.iter().map(|p| p.map(|x| x as f32)).collect()
}
