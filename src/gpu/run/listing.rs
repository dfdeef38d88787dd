//! The list of a correction's dispatches, and the buffers and bind groups of the list.

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::{filled, uniform, zeroed};
use crate::gpu::device::size::span_count;
use crate::gpu::encode::Passes;
use crate::gpu::kernels::dispatch::dispatch;
use crate::gpu::kernels::form::MeshForm;
use crate::gpu::kernels::layouts::{CoarseBindings, FineBindings, TransferBindings};
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{
    CoarseOp, FineOp, LatticeOp, SEARCH_STATE, StepOp, TransferOp,
};
use crate::gpu::mesh::{ElementPart, MeshBuffers};
use crate::gpu::run::pages::Pages;
use crate::gpu::scope::scoped;
use crate::run::multilevel::{CHEBYSHEV, Coarser, Level, NONE, Sparse};

/// A dispatch of a kernel with its uniform.
#[derive(Clone)]
pub(super) struct Dispatch {
    pub(super) pipeline: Pipeline,
    pub(super) op: Op,
    /// Index of the dispatch's uniform.
    pub(super) number: u32,
    /// Index of the dispatch's bind group.
    pub(super) bind_group: usize,
    pub(super) groups: Groups,
}

/// The uniform of a dispatch, by bind layout.
#[derive(Clone, Copy)]
pub(super) enum Op {
    Fine(FineOp),
    Transfer(TransferOp),
    Coarse(CoarseOp),
    Step(StepOp),
    Lattice(LatticeOp),
    /// A dispatch of a kernel whose layout has no operation.
    None,
}

impl Op {
    pub(super) fn rows(&self) -> u32 {
        match self {
            Op::Fine(op) => op.rows,
            Op::Transfer(op) => op.rows,
            Op::Coarse(op) => op.rows,
            Op::Step(op) => op.rows,
            Op::Lattice(op) => op.rows,
            Op::None => 0,
        }
    }

    pub(super) fn bytes(&self) -> &[u8] {
        match self {
            Op::Fine(op) => bytemuck::bytes_of(op),
            Op::Transfer(op) => bytemuck::bytes_of(op),
            Op::Coarse(op) => bytemuck::bytes_of(op),
            Op::Step(op) => bytemuck::bytes_of(op),
            Op::Lattice(op) => bytemuck::bytes_of(op),
            Op::None => &[],
        }
    }
}

/// Returns an operation on a coarse level, without its vectors and factors.
pub(super) fn coarse_op(rows: u32) -> CoarseOp {
    CoarseOp {
        rows,
        starts: 0,
        columns: 0,
        entries: 0,
        diagonal: 0,
        x: NONE,
        right: NONE,
        last_step: NONE,
        out: NONE,
        last_step_factor: 0.0,
        residual_factor: 0.0,
        right_factor: 0.0,
        product_factor: 0.0,
        partial_sums: NONE,
        totals: NONE,
        padding: 0,
    }
}

/// Returns the operations that add up the partial sums along a correction, each with its number of workgroups. The sums of the spans
/// follow the partial sums, in room for [`along_sums`] values.
pub(super) fn summing_ops(partials: u32, partial_sums: u32) -> Vec<(u32, CoarseOp)> {
    let op = CoarseOp { partial_sums, totals: TOTALS, ..coarse_op(partials) };
    match span_count(partials) {
        0 => vec![(1, op)],
        spans => {
            let of_spans = partial_sums + 4 * partials;
            let second = CoarseOp { rows: spans, partial_sums: of_spans, ..op };
            vec![(spans, CoarseOp { totals: of_spans, ..op }), (1, second)]
        }
    }
}

/// Returns the number of partial sums along a correction, with the sums of their spans.
pub(super) fn along_sums(partials: u32) -> u32 {
    4 * (partials + span_count(partials))
}

/// The number of workgroups of a dispatch.
#[derive(Clone, Copy)]
pub(super) enum Groups {
    /// As many workgroups as the rows of the operation need.
    ForRows,
    /// A fixed number of workgroups.
    Just(u32),
}

/// Indices of a bind group's resources: mesh part, structure page and value page.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Bound {
    Fine { part: usize },
    Transfer { part: usize, structure: usize, values: usize },
    Coarse { structure: usize, values: usize },
}

/// Offset of the four totals in `vectors`: 0, as readbacks copy the start of the buffer.
pub(super) const TOTALS: u32 = 0;
/// Offset of the partial sums in `vectors`. The vectors of the coarse levels follow the sums.
pub(super) const SUMS: u32 = SEARCH_STATE;

/// The content of the kernels' arrays, collected while the dispatches are listed.
pub(super) struct Listing<'g> {
    gpu: &'g Gpu,
    form: MeshForm,
    pub(super) structure: Pages<'g, u32>,
    pub(super) values: Pages<'g, f32>,
    pub(super) vectors: u32,
    bound: Vec<Bound>,
    pub(super) listed: u32,
}

impl<'g> Listing<'g> {
    pub(super) fn new(gpu: &'g Gpu, form: MeshForm) -> Self {
        Self {
            gpu,
            form,
            structure: Pages::new(gpu, "structure of the coarse levels"),
            values: Pages::new(gpu, "matrices of the coarse levels"),
            vectors: SUMS,
            bound: Vec::new(),
            listed: 0,
        }
    }

    /// Reserves a vector in `vectors`, and returns its offset.
    pub(super) fn vector(&mut self, length: usize) -> u32 {
        let at = self.vectors;
        self.vectors += length as u32;
        at
    }

    /// Stores a matrix and the reciprocals of its diagonal, an empty slice for none. Returns the pages and offsets of
    /// both.
    fn matrix(
        &mut self,
        matrix: &'g Sparse,
        diagonal: &'g [f32],
    ) -> Result<(Bound, CoarseOp), GpuError> {
        let (structure, [starts, columns]) =
            self.structure.place([matrix.starts(), matrix.columns()])?;
        let (values, [entries, diagonal]) = self.values.place([matrix.values(), diagonal])?;
        let op = coarse_op(matrix.rows() as u32);
        let op = CoarseOp { starts, columns, entries, diagonal, ..op };
        Ok((Bound::Coarse { structure, values }, op))
    }

    pub(super) fn step(
        &mut self,
        kernel: Kernel,
        bound: Bound,
        groups: Groups,
        op: Op,
    ) -> Result<Dispatch, GpuError> {
        self.step_in(self.form, &kernel, bound, groups, op)
    }

    /// Lists the dispatch of a kernel whose invocations go over a part of the elements.
    pub(super) fn step_on(
        &mut self,
        elements: &ElementPart,
        kernel: Kernel,
        bound: Bound,
        groups: Groups,
        op: Op,
    ) -> Result<Dispatch, GpuError> {
        self.step_in(elements.form(self.form), &kernel, bound, groups, op)
    }

    fn step_in(
        &mut self,
        form: MeshForm,
        kernel: &Kernel,
        bound: Bound,
        groups: Groups,
        op: Op,
    ) -> Result<Dispatch, GpuError> {
        let pipeline = self.gpu.pipelines.get(&self.gpu.device, kernel, form)?;
        let known = self.bound.iter().position(|&known| known == bound);
        let bind_group = known.unwrap_or(self.bound.len());
        if known.is_none() {
            self.bound.push(bound);
        }
        let number = self.listed;
        self.listed += 1;
        Ok(Dispatch { pipeline, op, number, bind_group, groups })
    }

    /// Appends the dispatches of one V-cycle over the levels to `list`. `right` is the offset of the right-hand side in
    /// `vectors`. Returns the offset of the solution.
    pub(super) fn solve(
        &mut self,
        levels: &'g [Level],
        right: u32,
        list: &mut Vec<Dispatch>,
    ) -> Result<u32, GpuError> {
        let Some((level, below)) = levels.split_first() else { return Ok(right) };
        let rows = level.operator.rows();
        let x = self.vector(rows);
        if let Coarser::Direct(inverse) = &level.coarser {
            let (values, [entries]) = self.values.place([&inverse[..]])?;
            let op = CoarseOp { entries, right, out: x, ..coarse_op(rows as u32) };
            let bound = Bound::Coarse { structure: 0, values };
            list.push(self.step(Kernel::CoarsestSolve, bound, Groups::ForRows, Op::Coarse(op))?);
            return Ok(x);
        }
        let (other, last_step) = (self.vector(rows), self.vector(rows));
        let (bound, operator) = self.matrix(&level.operator, &level.inverse_diagonal)?;
        let smoother = CoarseOp { right, last_step, ..operator };
        // Lists two steps of Chebyshev's iteration: one from the vector `from` (NONE for zero) to `over`, and one on to
        // `to`.
        let smooth = |listing: &mut Self, list: &mut Vec<Dispatch>, [from, over, to]: [u32; 3]| {
            let [first, again, now] = CHEBYSHEV;
            let one = CoarseOp { x: from, out: over, residual_factor: first, ..smoother };
            let two = CoarseOp {
                x: over,
                out: to,
                last_step_factor: again,
                residual_factor: now,
                ..smoother
            };
            for op in [one, two].map(Op::Coarse) {
                list.push(listing.step(Kernel::Chebyshev, bound, Groups::ForRows, op)?);
            }
            Ok::<(), GpuError>(())
        };
        smooth(self, list, [NONE, other, x])?;
        let Coarser::Level { prolongation, restriction } = &level.coarser else { return Ok(x) };
        let residual =
            CoarseOp { x, out: other, right_factor: 1.0, product_factor: -1.0, ..smoother };
        let residual = Op::Coarse(residual);
        list.push(self.step(Kernel::MatrixVector, bound, Groups::ForRows, residual)?);
        let below_right = self.vector(restriction.rows());
        list.push(self.matrix_vector(restriction, other, NONE, below_right)?);
        let solution = self.solve(below, below_right, list)?;
        list.push(self.matrix_vector(prolongation, solution, x, other)?);
        let end = self.vector(rows);
        smooth(self, list, [other, x, end])?;
        Ok(end)
    }

    /// Returns the dispatch of out = right + M x, with offsets in `vectors` for all three.
    fn matrix_vector(
        &mut self,
        matrix: &'g Sparse,
        x: u32,
        right: u32,
        out: u32,
    ) -> Result<Dispatch, GpuError> {
        let (bound, op) = self.matrix(matrix, &[])?;
        let op = CoarseOp { x, right, out, right_factor: 1.0, product_factor: 1.0, ..op };
        self.step(Kernel::MatrixVector, bound, Groups::ForRows, Op::Coarse(op))
    }

    /// Creates the buffers, and the bind groups of the listed dispatches. `params` is the uniform of the run on `mesh`.
    pub(super) async fn upload(
        &self,
        mesh: &MeshBuffers,
        free: u32,
        params: &wgpu::Buffer,
        ops: &[u8],
    ) -> Result<Uploaded, GpuError> {
        let gpu = self.gpu;
        let structure = self.structure.upload(gpu).await?;
        let values = self.values.upload(gpu).await?;
        scoped(&gpu.device, || self.bound(mesh, free, params, ops, [structure, values]))
    }

    /// Does the work of [`Self::upload`] after the pages of structure and values. To be called in an error scope.
    fn bound(
        &self,
        mesh: &MeshBuffers,
        free: u32,
        params: &wgpu::Buffer,
        ops: &[u8],
        [structure, values]: [Vec<wgpu::Buffer>; 2],
    ) -> Uploaded {
        let gpu = self.gpu;
        let ops = filled(gpu, "level steps", ops, Usage::UNIFORM | Usage::COPY_DST);
        let pairs = |label, length: u64| {
            let usage = Usage::STORAGE | Usage::COPY_SRC;
            zeroed(gpu, label, length * size_of::<[f32; 2]>() as u64, usage)
        };
        let vectors = pairs("level vectors", self.vectors.into());

        let [gradient, direction] =
            ["gradient", "correction"].map(|label| pairs(label, free.into()));
        let shared = Shared { mesh, params, ops: &ops, vectors: &vectors };
        let bind_groups = self.bound.iter().map(|&bound| {
            self.bind(bound, &shared, [&gradient, &direction], [&structure, &values])
        });
        let bind_groups = bind_groups.collect();
        Uploaded { bind_groups, ops, vectors, gradient, direction }
    }

    /// Binds the buffers of a dispatch. To be called in an error scope.
    fn bind(
        &self,
        bound: Bound,
        &Shared { mesh, params, ops, vectors }: &Shared<'_>,
        [gradient, direction]: [&wgpu::Buffer; 2],
        [structure, values]: [&[wgpu::Buffer]; 2],
    ) -> wgpu::BindGroup {
        let gpu = self.gpu;
        let (params, vectors) = (params.as_entire_binding(), vectors.as_entire_binding());
        match bound {
            Bound::Fine { part } => {
                let bindings = FineBindings {
                    params,
                    op: uniform::<FineOp>(ops),
                    positions: mesh.bind_positions(),
                    ring_start: mesh.ring_start.as_entire_binding(),
                    ring: mesh.bind_ring(part),
                    triangles: mesh.bind_elements(part),
                    gradient: gradient.as_entire_binding(),
                    direction: direction.as_entire_binding(),
                    vectors,
                };
                gpu.pipelines.bind(&gpu.device, self.form, bindings)
            }
            Bound::Transfer { part, structure: page, values: of_values } => {
                let bindings = TransferBindings {
                    params,
                    op: uniform::<TransferOp>(ops),
                    ring_start: mesh.ring_start.as_entire_binding(),
                    ring: mesh.bind_ring(part),
                    structure: structure[page].as_entire_binding(),
                    values: values[of_values].as_entire_binding(),
                    gradient: gradient.as_entire_binding(),
                    direction: direction.as_entire_binding(),
                    vectors,
                };
                gpu.pipelines.bind(&gpu.device, self.form, bindings)
            }
            Bound::Coarse { structure: page, values: of_values } => {
                let bindings = CoarseBindings {
                    params,
                    op: uniform::<CoarseOp>(ops),
                    structure: structure[page].as_entire_binding(),
                    values: values[of_values].as_entire_binding(),
                    vectors,
                };
                gpu.pipelines.bind(&gpu.device, self.form, bindings)
            }
        }
    }
}

/// The buffers that all listed dispatches bind.
struct Shared<'b> {
    mesh: &'b MeshBuffers,
    params: &'b wgpu::Buffer,
    ops: &'b wgpu::Buffer,
    vectors: &'b wgpu::Buffer,
}

/// The buffers and bind groups of the listed dispatches.
pub(super) struct Uploaded {
    pub(super) bind_groups: Vec<wgpu::BindGroup>,
    pub(super) ops: wgpu::Buffer,
    pub(super) vectors: wgpu::Buffer,
    pub(super) gradient: wgpu::Buffer,
    pub(super) direction: wgpu::Buffer,
}

/// Encodes a dispatch. `stride` is the distance between successive uniforms, in bytes.
pub(super) fn encode(
    passes: &mut Passes<'_>,
    bind_groups: &[wgpu::BindGroup],
    stride: u32,
    step: &Dispatch,
) {
    passes.run(&step.pipeline, None, |pass| {
        let uniform = [step.number * stride];
        let offsets = if matches!(step.op, Op::None) { &[] } else { &uniform[..] };
        pass.set_bind_group(0, &bind_groups[step.bind_group], offsets);
        match step.groups {
            Groups::ForRows => dispatch(pass, step.op.rows()),
            Groups::Just(groups) => pass.dispatch_workgroups(groups, 1, 1),
        }
    });
}

/// Returns the uniforms of `count` listed dispatches as one buffer's bytes, and the distance in bytes between two
/// successive uniforms.
pub(super) fn uniforms<'d>(
    gpu: &Gpu,
    listed: impl Iterator<Item = &'d Dispatch>,
    count: u32,
) -> (u32, Vec<u8>) {
    let alignment = gpu.device.limits().min_uniform_buffer_offset_alignment;
    let sizes = [
        size_of::<FineOp>(),
        size_of::<TransferOp>(),
        size_of::<CoarseOp>(),
        size_of::<StepOp>(),
        size_of::<LatticeOp>(),
    ];
    let largest = sizes.into_iter().fold(0, usize::max);
    let stride = (largest as u32).next_multiple_of(alignment);
    let mut ops = vec![0u8; (stride * count) as usize];
    for step in listed {
        let at = (step.number * stride) as usize;
        let op = step.op.bytes();
        ops[at..at + op.len()].copy_from_slice(op);
    }
    (stride, ops)
}
