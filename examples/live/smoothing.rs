//! The mesh on the device. Only this module of the application uses gpu-smooth.

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

/// Bytes of a vertex: x and y in f32.
const STRIDE: u64 = 8;
/// Byte offset of a move's completed fraction in the buffer of numbers. Objectives precede the fraction.
const SHARE: u64 = size_of::<ObjectiveValues>() as u64;
/// Largest inverse mean ratio that a drag may cause. A triangle that is worse before the drag may stay as bad.
const WORST: f64 = 8.0;
/// Number of untangling sweeps in each frame. Meshes without inverted triangles are left unchanged.
const UNTANGLING: u32 = 5;
/// Largest number of sweeps in a frame. `WITHOUT_CLOCK` is the fixed number on devices without timestamps.
const MOST: u32 = 16;
const WITHOUT_CLOCK: u32 = 4;

/// A mesh that is smoothed in the vertex buffer of the drawing. The host receives results some frames later, without
/// waiting.
pub(crate) struct Smoothing {
    pub(crate) gpu: Gpu,
    pub(crate) mesh: Mesh,
    pub(crate) topology: Topology<'static>,
    /// The vertex buffer of the drawing.
    pub(crate) vertices: wgpu::Buffer,
    /// Positions after the latest frame read back.
    pub(crate) points: Vec<[f64; 2]>,
    /// Objectives after the latest frame read back.
    pub(crate) objectives: ObjectiveValues,
    device_mesh: DeviceMesh,
    bound: BoundVertices,
    sweeps: Sweeps,
    untangling: UntanglingSweeps,
    objective: BoundObjective,
    scheme: Scheme,
    budget: Budget,
    has_clock: bool,
    /// The bound move of the held vertices. `None` if no vertex is held, or if triangles may invert.
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
        let sweeps = Sweeps::until_converged(&device_mesh, &options(&scheme)).block()?;
        let untangling = UntanglingSweeps::new(&device_mesh)?;
        // Compiling the kernels of all selectable schemes here prevents a frame from waiting for the compiler.
        Metric::ALL.iter().try_for_each(|&metric| gpu.prepare(&options(&metric.into())))?;
        let device = gpu.device();
        let vertices = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("vertices"),
            contents: bytemuck::cast_slice(&floats(&mesh.points)),
            // The smoother requires STORAGE, the drawing VERTEX and STORAGE.
            usage: Usage::VERTEX | Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST,
        });
        let buffer = |label, size, usage| {
            let (label, mapped_at_creation) = (Some(label), false);
            device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation })
        };
        let numbers = buffer("numbers", SHARE + 4, Usage::STORAGE | Usage::COPY_SRC);
        let targets = buffer("targets", vertices.size(), Usage::STORAGE | Usage::COPY_DST);
        let bound = device_mesh.bind_vertices(&VertexBuffer::new(vertices.slice(..), STRIDE))?;
        let objective = sweeps.bind_objective(numbers.slice(..))?;
        let has_clock = device.features().contains(Gpu::optional_features());
        let mut smoothing = Self {
            seen_points: Readback::new(&gpu, vertices.slice(..), mesh.points.len())?,
            seen_objectives: Readback::new(&gpu, numbers.slice(..), 1)?,
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

    /// Continues with another scheme, starting from the present vertices.
    pub(crate) fn set_scheme(&mut self, scheme: Scheme) -> Result<()> {
        self.sweeps = Sweeps::until_converged(&self.device_mesh, &options(&scheme)).block()?;
        self.objective = self.sweeps.bind_objective(self.numbers.slice(..))?;
        self.scheme = scheme;
        Ok(())
    }

    /// Sets the device time for sweeps in each frame. Without timestamps, the number of sweeps per frame is constant.
    pub(crate) fn set_budget(&mut self, micros: u64) -> Result<()> {
        let budget = Budget::micros(micros).at_most(MOST);
        self.budget = if self.has_clock { budget.timed_by(&self.gpu)? } else { budget };
        Ok(())
    }

    /// Pins exactly the vertices in `held`. With `clamp`, the device moves them, and stops before a triangle exceeds
    /// [`WORST`].
    pub(crate) fn hold(&mut self, held: &[u32], clamp: bool) -> Result<()> {
        self.device_mesh.set_pinned(held)?;
        let targets = VertexBuffer::new(self.targets.slice(..), STRIDE);
        let bind =
            || self.device_mesh.bind_move(held, &targets, WORST, self.numbers.slice(SHARE..));
        self.held = (clamp && !held.is_empty()).then(bind).transpose()?;
        Ok(())
    }

    /// Sets the positions of the held vertices for the next frame.
    pub(crate) fn aim(&mut self, held: &[u32], goals: &[[f64; 2]]) {
        let (queue, goals) = (self.gpu.queue(), floats(goals));
        if self.held.is_some() {
            queue.write_buffer(&self.targets, 0, bytemuck::cast_slice(&goals));
            return;
        }
        // Writes to the vertex buffer. Other vertices still have the floats of the last export, so the import ignores
        // them.
        for (&v, goal) in held.iter().zip(&goals) {
            queue.write_buffer(&self.vertices, u64::from(v) * STRIDE, bytemuck::bytes_of(goal));
        }
        self.moved = true;
    }

    /// Moves all vertices back to their positions in the mesh file.
    pub(crate) fn reset(&mut self) {
        let floats = floats(&self.mesh.points);
        self.gpu.queue().write_buffer(&self.vertices, 0, bytemuck::cast_slice(&floats));
        self.moved = true;
        self.sweeps.restart();
    }

    /// Encodes the work of a frame before its drawing: moves held vertices, untangles, sweeps within the budget, and
    /// exports the vertices. Returns the number of sweeps.
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

    /// Takes results of earlier frames that have been read back.
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

    /// Waits for the results of the last frame. An application without a window has no display that paces its frames.
    pub(crate) fn wait(&mut self) -> Result<()> {
        self.gpu.device().poll(wgpu::PollType::wait_indefinitely())?;
        self.receive()
    }

    /// Counts inverted and flat triangles by exact predicates on the device's positions.
    pub(crate) fn count_infeasible(&self) -> Result<usize> {
        let points = self.device_mesh.read_points().block()?;
        Ok(topology::infeasible(&points, self.topology.triangles())?.len())
    }
}

fn options(scheme: &Scheme) -> Options {
    Options::default().scheme(scheme.clone()).stopping(Stopping::Tolerance(1e-4))
}

fn floats(points: &[[f64; 2]]) -> Vec<[f32; 2]> {
    points.iter().map(|p| p.map(|x| x as f32)).collect()
}
