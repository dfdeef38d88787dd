//! The mesh on the device, with all bound resources and the frames.

use gpu_smooth::{Gpu, Method, Options, SmoothError, Stopping, gpu::{BoundMove, BoundObjective, BoundVertices, Budget, DeviceMesh, ObjectiveValues, Readback, Sweeps, UntanglingSweeps, VertexBuffer}, wgpu::{BufferUsages as Usage, self}};

use crate::plate::{Plate, Random};

/// Device time for sweeps in a frame, in microseconds, and the largest number of corrected sweeps.
const BUDGET: (u64, u32) = (5000, 6);
/// Largest inverse mean ratio that a drag may cause.
const WORST: f64 = 8.0;
/// Byte offset of a drag's completed fraction in the buffer of numbers. Objectives precede the fraction.
const SHARE: u64 = size_of::<ObjectiveValues>() as u64;

/// Objectives and vertices of the latest frame read back.
pub(crate) type Seen<'a> = (ObjectiveValues, &'a [[f32; 2]]);

pub(crate) struct Scene {
    gpu: Gpu,
    bound: BoundVertices,
    sweeps: Sweeps,
    untangling: UntanglingSweeps,
    budget: Budget,
    objective: BoundObjective,
    drag: BoundMove,
    /// Displacement of the hole during a drag; `None` if the user holds nothing.
    held: Option<[f32; 2]>,
    home: Vec<[f32; 2]>,
    vertices: wgpu::Buffer,
    targets: wgpu::Buffer,
    values: Readback<ObjectiveValues>,
    positions: Readback<[f32; 2]>,
    frames: u32,
}

impl Scene {
    /// Makes all resources of frames, and compiles the kernels. Errors occur here, not in frames. The function is async
    /// because a browser can create corrected sweeps only asynchronously.
    pub(crate) async fn new(gpu: &Gpu, plate: &Plate) -> Result<Self, SmoothError> {
        let mesh = &plate.mesh;
        let options = Options::default().method(Method::Multilevel).stopping(Stopping::Tolerance(1e-5));
        let device_mesh = DeviceMesh::new(gpu, mesh)?;
        let buffer = |label, size, usage| {
            gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let count = mesh.points.len();
        let single = |v: usize| mesh.points[v].map(|x| x as f32);
        let usage = Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST;
        let vertices = buffer("vertices", 8 * count as u64, usage);
        let content: Vec<[f32; 2]> = (0..count).map(single).collect();
        gpu.queue().write_buffer(&vertices, 0, bytemuck::cast_slice(&content));
        let numbers = buffer("numbers", SHARE + 4, usage);
        let targets = buffer("targets", 8 * plate.hole.len() as u64, usage);

        let bound = device_mesh.bind_vertices(&VertexBuffer::new(vertices.slice(..), 8))?;
        let sweeps = Sweeps::until_converged(&device_mesh, &options).await?;
        // Browsers round timestamps to approximately a tenth of a millisecond.
        let budget = Budget::micros(BUDGET.0).at_most(BUDGET.1);
        let budget = match gpu.device().features().contains(Gpu::optional_features()) {
            true => budget.timed_by(gpu)?,
            false => budget,
        };
        let to = VertexBuffer::new(targets.slice(..), 8);
        Ok(Self {
            untangling: UntanglingSweeps::new(&device_mesh)?,
            objective: sweeps.bind_objective(numbers.slice(..))?,
            drag: device_mesh.bind_move(&plate.hole, &to, WORST, numbers.slice(SHARE..))?,
            held: None,
            home: plate.hole.iter().map(|&v| single(v as usize)).collect(),
            values: Readback::new(gpu, numbers.slice(..), 1)?,
            positions: Readback::new(gpu, vertices.slice(..), count)?,
            frames: 0,
            gpu: gpu.clone(),
            bound,
            sweeps,
            budget,
            vertices,
            targets,
        })
    }

    /// Encodes and submits a frame without waiting for the device.
    pub(crate) fn frame(&mut self) {
        let (device, queue) = (self.gpu.device(), self.gpu.queue());
        let mut encoder = device.create_command_encoder(&Default::default());
        self.bound.encode_import(&mut encoder);
        if let Some(by) = self.held {
            let moved = |place: &[f32; 2]| [place[0] + by[0], place[1] + by[1]];
            let to: Vec<[f32; 2]> = self.home.iter().map(moved).collect();
            queue.write_buffer(&self.targets, 0, bytemuck::cast_slice(&to));
            self.drag.encode_move(&mut encoder);
        }
        self.untangling.encode_untangle(&mut encoder, 3);
        self.sweeps.encode_within(&mut encoder, &mut self.budget);
        self.objective.encode_objective(&mut encoder);
        self.bound.encode_export(&mut encoder);
        self.values.encode_readback(&mut encoder);
        self.positions.encode_readback(&mut encoder);
        queue.submit([encoder.finish()]);
        self.frames += 1;
    }

    /// Sets the displacement of the hole from its original position; `None` releases the hole.
    pub(crate) fn hold(&mut self, by: Option<[f32; 2]>) {
        self.held = by;
    }

    /// Displaces every ninth interior vertex, as a kernel of an application might do.
    pub(crate) fn tear(&mut self, plate: &Plate) {
        let mut random = Random(2);
        for v in plate.some(9) {
            let [x, y] = plate.mesh.points[v as usize];
            let place = [x + 0.3 * random.next(), y + 0.3 * random.next()].map(|x| x as f32);
            let at = 8 * u64::from(v);
            self.gpu.queue().write_buffer(&self.vertices, at, bytemuck::bytes_of(&place));
        }
    }

    /// Returns objectives and vertices of the latest frame read back; `None` before the first.
    pub(crate) fn seen(&mut self) -> Result<Option<Seen<'_>>, SmoothError> {
        let values = self.values.latest()?.map(|values| values[0]);
        let positions = self.positions.latest()?;
        Ok(values.zip(positions))
    }

    /// Returns the number of sweeps that the budget allows in the next frame.
    pub(crate) fn sweeps(&self) -> u32 {
        self.budget.sweeps()
    }

    pub(crate) fn frames(&self) -> u32 {
        self.frames
    }

    /// Returns the number of submitted frames that have not been read back.
    pub(crate) fn behind(&self) -> u32 {
        self.values.age().map_or(self.frames, |age| age as u32)
    }
}
