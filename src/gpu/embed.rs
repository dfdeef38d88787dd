//! A mesh that stays on an application's device, and sweeps for its command encoder.

use wgpu::BufferUsages as Usage;

use super::buffers::{MeshBuffers, filled};
use super::device::{Gpu, GpuError, scoped};
use super::exchange::{VertexBuffer, bind_objectives, bind_vertices, pipeline};
use super::layout::{HELD, SLOTS, join};
use super::readback::{self, Waiting};
use super::run::{Run, dispatch};
use super::shaders::Kernel;
use crate::error::SmoothError;
use crate::mesh::Mesh;
use crate::options::Options;
use crate::plan::{Plan, StopRule};
use crate::prepare;
use crate::problem::Problem;

/// A mesh on the device, as long as its triangles stay. Several can be alive at once.
///
/// Its vertices are moved by [`Sweeps`], or by the application through
/// [`encode_import`](Self::encode_import), topology and pipelines staying as they are. So does the mean
/// area of the triangles that AREA and RMS measure by: where the application makes the whole mesh larger or
/// smaller, IMR, AR and EDGE suit better.
pub struct DeviceMesh {
    problem: Problem,
    buffers: MeshBuffers,
    /// The application's number of each vertex.
    numbers: wgpu::Buffer,
    vertex_count: usize,
}

impl DeviceMesh {
    /// Prepares a mesh and uploads it. Blocks while it colors the vertices.
    ///
    /// The vertices of [`Mesh::fixed`] stay until [`set_fixed`](Self::set_fixed) says otherwise.
    ///
    /// # Errors
    /// [`SmoothError::Mesh`] if the mesh cannot be smoothed, [`SmoothError::Gpu`] with
    /// [`GpuError::Limit`] if it is too large for the device.
    pub fn new(gpu: &Gpu, mesh: &Mesh) -> Result<Self, SmoothError> {
        let unconstrained = Mesh { fixed: Vec::new(), ..mesh.clone() };
        let (_, problem) = prepare::prepare(&unconstrained)?;
        let buffers = MeshBuffers::new(gpu, &problem, problem.positions())?;
        let numbers = scoped(&gpu.device, || {
            filled(gpu, "vertex numbers", problem.vertices(), Usage::STORAGE)
        })?;
        let vertex_count = mesh.points.len();
        let device_mesh = Self { problem, buffers, numbers, vertex_count };
        let mut fixed = vec![false; vertex_count];
        for &v in &mesh.fixed {
            match fixed.get_mut(v as usize) {
                Some(flag) => *flag = true,
                None => {
                    let vertices = vertex_count;
                    let error = crate::error::MeshError::IndexOutOfRange {
                        triangle: None,
                        vertex: v,
                        vertices,
                    };
                    return Err(error.into());
                }
            }
        }
        device_mesh.set_fixed(gpu, &fixed)?;
        Ok(device_mesh)
    }

    /// Says for each vertex of the mesh whether it is to stay where it is. Boundary vertices always
    /// stay. Takes effect in what is submitted after the call.
    ///
    /// # Errors
    /// [`GpuError::Buffer`] unless there is one flag for each vertex.
    pub fn set_fixed(&self, gpu: &Gpu, fixed: &[bool]) -> Result<(), GpuError> {
        if fixed.len() != self.vertex_count {
            let count = fixed.len();
            let problem = format!("{count} flags were given for {} vertices", self.vertex_count);
            return Err(GpuError::Buffer(problem));
        }
        let mut starts = self.problem.ring_start().to_vec();
        // One start a free vertex; the entry after them is the end of the last ring.
        let free = self.problem.free_count();
        for (start, &vertex) in starts[..free].iter_mut().zip(self.problem.vertices()) {
            *start |= if fixed[vertex as usize] { HELD } else { 0 };
        }
        scoped(&gpu.device, || {
            gpu.queue.write_buffer(&self.buffers.ring_start, 0, bytemuck::cast_slice(&starts));
        })
    }

    /// Takes all positions, of fixed vertices too, from the application's vertex buffer, as it is when
    /// the command buffer runs.
    ///
    /// A vertex whose floats are those of the last export has not been moved by the application and
    /// keeps its full precision. A position that is not a finite number is not taken: the vertex stays
    /// where it was. Triangles may arrive inverted; sweeps then go on around them.
    ///
    /// # Errors
    /// [`GpuError::Buffer`] if the buffer is too small, misaligned or was made without `STORAGE`.
    pub fn encode_import(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        from: &VertexBuffer<'_>,
    ) -> Result<(), GpuError> {
        self.encode_exchange(gpu, encoder, from, Kernel::Import)
    }

    /// Writes all positions into the application's vertex buffer: of every vertex that a triangle uses, x
    /// and y and nothing else.
    ///
    /// # Errors
    /// As [`encode_import`](Self::encode_import).
    pub fn encode_export(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        to: &VertexBuffer<'_>,
    ) -> Result<(), GpuError> {
        self.encode_exchange(gpu, encoder, to, Kernel::Export)
    }

    fn encode_exchange(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        with: &VertexBuffer<'_>,
        kernel: Kernel,
    ) -> Result<(), GpuError> {
        let (problem, buffers) = (&self.problem, &self.buffers);
        let bind_group = bind_vertices(
            gpu,
            problem,
            self.vertex_count,
            &buffers.positions,
            &self.numbers,
            with,
        )?;
        let label = kernel.label();
        let pipeline = pipeline(gpu, kernel)?;
        scoped(&gpu.device, || {
            let mut pass = begin(encoder, &label);
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bind_group, &[]);
            dispatch(&mut pass, problem.positions().len() as u32);
        })
    }

    /// Reads the positions back, in the mesh's order and units; blocks until the device has done all
    /// that was submitted. `mesh` is the mesh this was made of: vertices in no triangle are taken
    /// from it.
    ///
    /// # Errors
    /// [`GpuError::Lost`] if the device is lost.
    pub fn read_points(&self, gpu: &Gpu, mesh: &Mesh) -> Result<Vec<[f64; 2]>, GpuError> {
        let count = self.problem.positions().len();
        let positions: Vec<[f32; 4]> = pollster::block_on(readback::read(
            gpu,
            &self.buffers.positions,
            count,
            Waiting::Block,
        ))?;
        let positions: Vec<_> = positions.into_iter().map(join).collect();
        Ok(self.problem.denormalize_all(mesh, &positions))
    }
}

fn begin<'e>(encoder: &'e mut wgpu::CommandEncoder, label: &str) -> wgpu::ComputePass<'e> {
    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
        label: Some(label),
        timestamp_writes: None,
    })
}

/// A scheme bound to a mesh on the device. Encodes into the application's command encoder; never submits,
/// never reads back, never stops by itself.
///
/// Several can be bound to one mesh, and those of several meshes interleaved in one encoder.
pub struct Sweeps {
    run: Run,
    triangles: usize,
    done: u32,
}

impl Sweeps {
    /// Binds the scheme, relaxation and derivatives of `options` to a mesh. What `options` say on
    /// stopping has no effect here.
    ///
    /// # Errors
    /// [`SmoothError::Option`] for an option out of its range, or what the device refuses.
    pub fn new(gpu: &Gpu, mesh: &DeviceMesh, options: &Options) -> Result<Self, SmoothError> {
        options.check()?;
        let stop = StopRule { target: None, tolerance: 0.0, max_sweeps: u32::MAX };
        let plan = Plan { stop, ..options.plan(None) };
        let run = Run::new(gpu, &mesh.problem, &mesh.buffers, plan, false)?;
        Ok(Self { run, triangles: mesh.problem.triangles().len(), done: 0 })
    }

    /// Encodes `sweeps` further sweeps. The scheme goes on where the last call left it.
    pub fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, sweeps: u32) {
        let mut pass = begin(encoder, "gpu-smooth sweeps");
        for _ in 0..sweeps {
            self.done = self.done.saturating_add(1);
            self.run.encode_sweep(&mut pass, self.done);
        }
    }

    /// Encodes the evaluation of the objectives as they are at this point of the command buffer, and writes
    /// [`OBJECTIVE_FLOATS`](Self::OBJECTIVE_FLOATS) f32 into `buffer` at byte `offset`: f by each
    /// metric in the order of [`Metric::ALL`](crate::Metric::ALL) (0 for one that
    /// [`Options::track_all`] does not ask for and that is not the base), then the number of
    /// triangles that are inverted or flat in single precision. Unless that number is 0, f by IMR and AR
    /// says nothing.
    ///
    /// # Errors
    /// [`GpuError::Buffer`] if the buffer is too small, misaligned or was made without `STORAGE`.
    pub fn encode_objective(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        buffer: &wgpu::Buffer,
        offset: u64,
    ) -> Result<(), GpuError> {
        let (tracked, control) = (self.run.plan.tracked(), &self.run.control);
        let bind_group = bind_objectives(gpu, self.triangles, &tracked, control, buffer, offset)?;
        let pipeline = pipeline(gpu, Kernel::Publish)?;
        scoped(&gpu.device, || {
            let mut pass = begin(encoder, "gpu-smooth objective");
            self.run.encode_evaluation(&mut pass);
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bind_group, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        })
    }

    /// Number of f32 that [`encode_objective`](Self::encode_objective) writes.
    pub const OBJECTIVE_FLOATS: usize = SLOTS;

    /// Starts the scheme anew: plain sweeps first, over-relaxed ones after. To be called when the
    /// application has moved vertices far.
    pub fn restart(&mut self) {
        self.done = 0;
    }
}
