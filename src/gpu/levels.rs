//! The levels of a hierarchy on the device, and the dispatches of a correction.

use wgpu::BufferUsages as Usage;

use super::buffers::{MeshBuffers, filled, uniform, zeroed};
use super::device::{Gpu, GpuError, scoped};
use super::kernel::Pipeline;
use super::layout::{LevelOp, WORKGROUP};
use super::passes::Passes;
use super::run::dispatch;
use super::shaders::{Interface, Kernel, Positions};
use super::size::{NUMBER, POSITION, TRIANGLE, check_limit, objective_invocations};
use crate::metric::Metric;
use crate::multilevel::{CHEBYSHEV, Coarser, Hierarchy, Level, NONE, Sparse};
use crate::problem::Problem;

/// A hierarchy bound to a mesh on the device: encodes, submits nothing.
pub(super) struct Levels {
    bind_group: wgpu::BindGroup,
    ops: wgpu::Buffer,
    /// Bytes from one uniform to the next.
    stride: u32,
    /// From the positions to the correction.
    correction: Vec<Dispatch>,
    along: Dispatch,
    total: Dispatch,
    take: Dispatch,
    pub(super) vectors: wgpu::Buffer,
}

struct Dispatch {
    pipeline: Pipeline,
    op: LevelOp,
    /// Which uniform it is.
    number: u32,
    groups: Groups,
}

enum Groups {
    ForRows,
    Just(u32),
}

/// Places in `vectors`: the totals first, so that they can be read back, then the gradient, the correction
/// and the partial sums; vectors of coarse levels after them.
const TOTALS: u32 = 0;
const GRADIENT: u32 = 4;

/// What is written to the three arrays of the kernels while the dispatches are listed.
struct Layout<'g> {
    gpu: &'g Gpu,
    structure: Vec<u32>,
    values: Vec<f32>,
    vectors: u32,
    listed: u32,
}

/// Where a matrix is.
#[derive(Clone, Copy)]
struct Place {
    starts: u32,
    columns: u32,
    entries: u32,
}

impl Layout<'_> {
    fn structure(&mut self, numbers: &[u32]) -> u32 {
        let at = self.structure.len() as u32;
        self.structure.extend_from_slice(numbers);
        at
    }

    fn values(&mut self, values: &[f32]) -> u32 {
        let at = self.values.len() as u32;
        self.values.extend_from_slice(values);
        at
    }

    fn vector(&mut self, length: usize) -> u32 {
        let at = self.vectors;
        self.vectors += length as u32;
        at
    }

    fn matrix(&mut self, matrix: &Sparse) -> Place {
        let starts = self.structure(matrix.starts());
        let columns = self.structure(matrix.columns());
        Place { starts, columns, entries: self.values(matrix.values()) }
    }

    fn step(&mut self, kernel: Kernel, groups: Groups, op: LevelOp) -> Result<Dispatch, GpuError> {
        let pipeline = self.gpu.pipelines.get(&self.gpu.device, &kernel, Positions::Whole)?;
        let number = self.listed;
        self.listed += 1;
        Ok(Dispatch { pipeline, op, number, groups })
    }

    /// Lists one V-cycle over the levels, from the right-hand side to the solution, whose place is returned.
    fn solve(
        &mut self,
        levels: &[Level],
        right: u32,
        list: &mut Vec<Dispatch>,
    ) -> Result<u32, GpuError> {
        let Some((level, below)) = levels.split_first() else { return Ok(right) };
        let rows = level.operator.rows();
        let x = self.vector(rows);
        if let Coarser::Direct(inverse) = &level.coarser {
            let op = LevelOp {
                rows: rows as u32,
                entries: self.values(inverse),
                right,
                out: x,
                ..LevelOp::default()
            };
            list.push(self.step(Kernel::Direct, Groups::ForRows, op)?);
            return Ok(x);
        }
        let (other, step) = (self.vector(rows), self.vector(rows));
        let operator = self.matrix(&level.operator);
        let smoother = LevelOp {
            rows: rows as u32,
            starts: operator.starts,
            columns: operator.columns,
            entries: operator.entries,
            diagonal: self.values(&level.inverse_diagonal),
            right,
            step,
            ..LevelOp::default()
        };
        // Two steps from the first vector (or zero) over the second to the third.
        let smooth = |layout: &mut Self, list: &mut Vec<Dispatch>, [from, over, to]: [u32; 3]| {
            let [first, again, now] = CHEBYSHEV;
            let one = LevelOp { x: from, out: over, b: first, ..smoother };
            let two = LevelOp { x: over, out: to, a: again, b: now, ..smoother };
            list.push(layout.step(Kernel::Chebyshev, Groups::ForRows, one)?);
            list.push(layout.step(Kernel::Chebyshev, Groups::ForRows, two)?);
            Ok::<(), GpuError>(())
        };
        smooth(self, list, [NONE, other, x])?;
        let Coarser::Level { prolongation, restriction } = &level.coarser else { return Ok(x) };
        let residual = LevelOp { x, out: other, a: 1.0, b: -1.0, ..smoother };
        list.push(self.step(Kernel::Apply, Groups::ForRows, residual)?);
        let below_right = self.vector(restriction.rows());
        let down = self.apply(restriction, other, NONE, below_right);
        list.push(self.step(Kernel::Apply, Groups::ForRows, down)?);
        let solution = self.solve(below, below_right, list)?;
        let up = self.apply(prolongation, solution, x, other);
        list.push(self.step(Kernel::Apply, Groups::ForRows, up)?);
        let end = self.vector(rows);
        smooth(self, list, [other, x, end])?;
        Ok(end)
    }

    /// out = right + M x.
    fn apply(&mut self, matrix: &Sparse, x: u32, right: u32, out: u32) -> LevelOp {
        let Place { starts, columns, entries } = self.matrix(matrix);
        let rows = matrix.rows() as u32;
        LevelOp {
            rows,
            starts,
            columns,
            entries,
            x,
            right,
            out,
            a: 1.0,
            b: 1.0,
            ..LevelOp::default()
        }
    }
}

impl Gpu {
    /// Says, before anything is allocated, whether the device corrects sweeps on a mesh from coarser levels: only where
    /// it binds all of the mesh at once.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if not.
    pub(crate) fn check_levels(&self, problem: &Problem) -> Result<(), GpuError> {
        let limits = self.device.limits();
        let rings = problem.ring().len() as u64 * NUMBER;
        let triangles = problem.triangles().len() as u64 * TRIANGLE;
        let positions = problem.positions().len() as u64 * POSITION;
        let what = || "a mesh that is corrected from coarser levels".to_owned();
        let bound = limits.max_storage_buffer_binding_size;
        let needed = rings.max(triangles).max(positions);
        check_limit("max_storage_buffer_binding_size", bound, &what, needed)
    }
}

impl Levels {
    /// Uploads a hierarchy and makes the pipelines it needs. `params` are those of the run on `mesh`.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if it is too large for the device.
    pub(super) fn new(
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        params: &wgpu::Buffer,
        metric: Metric,
        hierarchy: &Hierarchy,
    ) -> Result<Self, GpuError> {
        let free = problem.free_count() as u32;
        let mut layout =
            Layout { gpu, structure: Vec::new(), values: Vec::new(), vectors: GRADIENT, listed: 0 };
        let gradient = layout.vector(free as usize);
        let direction = layout.vector(free as usize);
        let partials = objective_invocations(problem.triangles().len());
        let groups = partials / WORKGROUP;
        let sums = layout.vector(4 * partials as usize);

        let (sizes, doubled_stiffness) = hierarchy.sizes();
        let aggregates = hierarchy.member_starts().len() as u32 - 1;
        let fine = LevelOp {
            rows: free,
            free,
            entries: layout.values(sizes),
            diagonal: layout.values(hierarchy.inverse_diagonal()),
            a: doubled_stiffness,
            ..LevelOp::default()
        };
        let of = layout.structure(hierarchy.aggregate_of());
        let starts = layout.structure(hierarchy.member_starts());
        let columns = layout.structure(hierarchy.members());
        let right = layout.vector(aggregates as usize);

        let mut correction = Vec::new();
        let rows = Groups::ForRows;
        let op = LevelOp { out: gradient, ..fine };
        correction.push(layout.step(Kernel::Gradient(metric), rows, op)?);
        let op = LevelOp { rows: aggregates, starts, columns, x: gradient, out: right, ..fine };
        correction.push(layout.step(Kernel::HandDown, Groups::ForRows, op)?);
        let solution = layout.solve(hierarchy.levels(), right, &mut correction)?;
        let op = LevelOp { starts: of, x: solution, out: direction, ..fine };
        correction.push(layout.step(Kernel::HandUp, Groups::ForRows, op)?);

        let op = LevelOp { x: direction, right: gradient, out: sums, ..fine };
        let along = layout.step(Kernel::Along(metric), Groups::Just(groups), op)?;
        let op = LevelOp { rows: partials, x: sums, out: TOTALS, ..LevelOp::default() };
        let total = layout.step(Kernel::Total, Groups::Just(1), op)?;
        let op = LevelOp { x: direction, ..fine };
        let take = layout.step(Kernel::Take, Groups::ForRows, op)?;

        let alignment = gpu.device.limits().min_uniform_buffer_offset_alignment;
        let stride = (size_of::<LevelOp>() as u32).next_multiple_of(alignment);
        let mut uniforms = vec![0u8; (stride * layout.listed) as usize];
        for step in correction.iter().chain([&along, &total, &take]) {
            let at = (step.number * stride) as usize;
            uniforms[at..at + size_of::<LevelOp>()].copy_from_slice(bytemuck::bytes_of(&step.op));
        }
        let vector_bytes = u64::from(layout.vectors) * size_of::<[f32; 2]>() as u64;
        for (what, needed) in [
            ("the vectors of the coarse levels", vector_bytes),
            ("the structure of the coarse levels", layout.structure.len() as u64 * 4),
            ("the matrices of the coarse levels", layout.values.len() as u64 * 4),
        ] {
            let limits = gpu.device.limits();
            let what = || what.to_owned();
            let bound = limits.max_storage_buffer_binding_size;
            check_limit("max_storage_buffer_binding_size", bound, &what, needed)?;
            check_limit("max_buffer_size", limits.max_buffer_size, &what, needed)?;
        }
        let (ops, vectors, bind_group) = scoped(&gpu.device, || {
            let ops = filled(gpu, "level steps", &uniforms, Usage::UNIFORM | Usage::COPY_DST);
            let structure = filled(gpu, "level structure", &layout.structure, Usage::STORAGE);
            let values = filled(gpu, "level values", &layout.values, Usage::STORAGE);
            let usage = Usage::STORAGE | Usage::COPY_SRC;
            let vectors = zeroed(gpu, "level vectors", vector_bytes, usage);
            let resources = [
                params.as_entire_binding(),
                uniform::<LevelOp>(&ops),
                mesh.positions.as_entire_binding(),
                mesh.ring_start.as_entire_binding(),
                mesh.ring.as_entire_binding(),
                mesh.triangles.as_entire_binding(),
                structure.as_entire_binding(),
                values.as_entire_binding(),
                vectors.as_entire_binding(),
            ];
            let bind_group =
                gpu.pipelines.bind(&gpu.device, Interface::Levels, Positions::Whole, &resources);
            (ops, vectors, bind_group)
        })?;
        Ok(Self { bind_group, ops, stride, correction, along, total, take, vectors })
    }

    /// From the positions to the correction.
    pub(super) fn encode_correction(&self, passes: &mut Passes<'_>) {
        self.correction.iter().for_each(|step| self.encode(passes, step));
    }

    /// Evaluates the objective along the correction; the totals are then at the start of `vectors`.
    pub(super) fn encode_along(&self, passes: &mut Passes<'_>) {
        self.encode(passes, &self.along);
        self.encode(passes, &self.total);
    }

    /// Moves the vertices along the correction.
    pub(super) fn encode_take(&self, passes: &mut Passes<'_>) {
        self.encode(passes, &self.take);
    }

    /// Sets how far the next submission goes along the correction.
    pub(super) fn set_length(&self, gpu: &Gpu, length: f32) {
        for step in [&self.along, &self.take] {
            let op = LevelOp { a: length, ..step.op };
            let at = u64::from(step.number * self.stride);
            gpu.queue.write_buffer(&self.ops, at, bytemuck::bytes_of(&op));
        }
    }

    fn encode(&self, passes: &mut Passes<'_>, step: &Dispatch) {
        passes.run(&step.pipeline, None, |pass| {
            pass.set_bind_group(0, &self.bind_group, &[step.number * self.stride]);
            match step.groups {
                Groups::ForRows => dispatch(pass, step.op.rows),
                Groups::Just(groups) => pass.dispatch_workgroups(groups, 1, 1),
            }
        });
    }
}
