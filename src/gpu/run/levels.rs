//! Coarse levels of a mesh on the device, and the dispatches of a correction.

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::{filled, uniform, zeroed};
use crate::gpu::device::size::{check_limit, objective_invocations};
use crate::gpu::encode::Passes;
use crate::gpu::kernels::dispatch::dispatch;
use crate::gpu::kernels::form::MeshForm;
use crate::gpu::kernels::layouts::{CoarseBindings, FineBindings, TransferBindings};
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{
    CoarseOp, FineOp, NO_GUARD, SEARCH_STATE, TransferOp, WORKGROUP,
};
use crate::gpu::mesh::MeshBuffers;
use crate::gpu::mesh::RingPart;
use crate::gpu::run::dispatches::Dispatches;
use crate::gpu::run::pages::Pages;
use crate::gpu::scope::scoped;
use crate::layout::Problem;
use crate::metric::Smoothing;
use crate::parallel::pace::pause;
use crate::run::EXCLUSION_PASSES;
use crate::run::multilevel::{CHEBYSHEV, Coarser, Hierarchy, Level, NONE, Sparse};

/// A hierarchy bound to a mesh on the device. The methods encode corrections and submit nothing.
pub(crate) struct Levels {
    bind_groups: Vec<wgpu::BindGroup>,
    ops: wgpu::Buffer,
    /// Distance between successive uniforms, in bytes.
    stride: u32,
    /// The smoothing of EDGE that the uniforms hold.
    smoothing: Smoothing,
    /// The dispatches that compute the gradient from the positions.
    find_gradient: Vec<Dispatch>,
    /// The dispatches that compute the correction from the gradient.
    correction: Vec<Dispatch>,
    /// The dispatches that exclude vertices of broken triangles from the correction, once. Empty for runs without a
    /// shape guard.
    left_out: Vec<Dispatch>,
    objective: Vec<Dispatch>,
    sum: Dispatch,
    movement: Dispatch,
    pub(crate) vectors: wgpu::Buffer,
    /// The gradient of Σ q² at each free vertex.
    pub(crate) gradient: wgpu::Buffer,
    /// The correction at each free vertex.
    pub(crate) direction: wgpu::Buffer,
}

/// The occasion on which levels are fitted to the present stiffness of the mesh.
pub(crate) enum Fitting {
    /// When the host provides new levels.
    ByHost,
    /// In each correction, by a factor at each free vertex.
    EachTime,
}

struct Dispatch {
    pipeline: Pipeline,
    op: Op,
    /// Index of the dispatch's uniform.
    number: u32,
    /// Index of the dispatch's bind group.
    bind_group: usize,
    groups: Groups,
}

/// The uniform of a dispatch, by bind layout.
#[derive(Clone, Copy)]
enum Op {
    Fine(FineOp),
    Transfer(TransferOp),
    Coarse(CoarseOp),
}

impl Op {
    fn rows(&self) -> u32 {
        match self {
            Op::Fine(op) => op.rows,
            Op::Transfer(op) => op.rows,
            Op::Coarse(op) => op.rows,
        }
    }

    fn bytes(&self) -> &[u8] {
        match self {
            Op::Fine(op) => bytemuck::bytes_of(op),
            Op::Transfer(op) => bytemuck::bytes_of(op),
            Op::Coarse(op) => bytemuck::bytes_of(op),
        }
    }
}

/// Returns an operation on a coarse level, without its vectors and factors.
fn coarse_op(rows: u32) -> CoarseOp {
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

enum Groups {
    ForRows,
    Just(u32),
}

/// Indices of a bind group's resources: mesh part, structure page and value page.
#[derive(Clone, Copy, PartialEq)]
enum Bound {
    Fine { part: usize },
    Transfer { part: usize, structure: usize, values: usize },
    Coarse { structure: usize, values: usize },
}

/// Offset of the four totals in `vectors`: 0, as readbacks copy the start of the buffer.
const TOTALS: u32 = 0;
/// Offset of the partial sums in `vectors`. The vectors of the coarse levels follow the sums.
const SUMS: u32 = SEARCH_STATE;

/// The content of the kernels' arrays, collected while the dispatches are listed.
struct Listing<'g> {
    gpu: &'g Gpu,
    form: MeshForm,
    structure: Pages<'g, u32>,
    values: Pages<'g, f32>,
    vectors: u32,
    bound: Vec<Bound>,
    listed: u32,
}

impl<'g> Listing<'g> {
    fn vector(&mut self, length: usize) -> u32 {
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

    fn step(
        &mut self,
        kernel: Kernel,
        bound: Bound,
        groups: Groups,
        op: Op,
    ) -> Result<Dispatch, GpuError> {
        let pipeline = self.gpu.pipelines.get(&self.gpu.device, &kernel, self.form)?;
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
    fn solve(
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
    async fn upload(
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
        let bind_groups = self.bound.iter().map(|&bound| {
            let params = params.as_entire_binding();
            let vectors = vectors.as_entire_binding();
            match bound {
                Bound::Fine { part } => {
                    let bindings = FineBindings {
                        params,
                        op: uniform::<FineOp>(&ops),
                        positions: mesh.bind_positions(),
                        ring_start: mesh.ring_start.as_entire_binding(),
                        ring: mesh.bind_ring(part),
                        triangles: mesh.bind_triangles(part),
                        gradient: gradient.as_entire_binding(),
                        direction: direction.as_entire_binding(),
                        vectors,
                    };
                    gpu.pipelines.bind(&gpu.device, self.form, bindings)
                }
                Bound::Transfer { part, structure: page, values: of_values } => {
                    let bindings = TransferBindings {
                        params,
                        op: uniform::<TransferOp>(&ops),
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
                        op: uniform::<CoarseOp>(&ops),
                        structure: structure[page].as_entire_binding(),
                        values: values[of_values].as_entire_binding(),
                        vectors,
                    };
                    gpu.pipelines.bind(&gpu.device, self.form, bindings)
                }
            }
        });
        let bind_groups = bind_groups.collect();
        Uploaded { bind_groups, ops, vectors, gradient, direction }
    }
}

struct Uploaded {
    bind_groups: Vec<wgpu::BindGroup>,
    ops: wgpu::Buffer,
    vectors: wgpu::Buffer,
    gradient: wgpu::Buffer,
    direction: wgpu::Buffer,
}

impl Levels {
    /// Uploads a hierarchy and creates the pipelines for corrections of a run by its base metric.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the levels are too large for the device, or another [`GpuError`] if the device fails.
    pub(crate) async fn new(
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        dispatches: &Dispatches,
        hierarchy: &Hierarchy,
        fitting: Fitting,
    ) -> Result<Self, GpuError> {
        let metric = dispatches.plan.scheme.base();
        let guard = dispatches.plan.base_step(1.0).shape_guard.min(NO_GUARD) as f32;
        let mut kernels = vec![
            Kernel::Gradient(metric),
            Kernel::SmoothGradient,
            Kernel::Restrict,
            Kernel::CoarsestSolve,
            Kernel::Prolong,
            Kernel::ObjectiveAlongCorrection(metric),
            Kernel::SumAlongCorrection,
            Kernel::MoveAlongCorrection,
        ];
        let has_guard = guard < NO_GUARD as f32;
        if has_guard {
            kernels.extend([Kernel::FindBroken, Kernel::ExcludeBroken]);
        }
        if hierarchy.levels().len() > 1 {
            kernels.extend([Kernel::Chebyshev, Kernel::MatrixVector]);
        }
        // Compiled here with pauses, so that the listing finds every kernel compiled.
        for kernel in kernels {
            gpu.pipelines.get(&gpu.device, &kernel, mesh.parts.form())?;
            pause().await;
        }
        let mut listing = Listing {
            gpu,
            form: mesh.parts.form(),
            structure: Pages::new(gpu, "structure of the coarse levels"),
            values: Pages::new(gpu, "matrices of the coarse levels"),
            vectors: SUMS,
            bound: Vec::new(),
            listed: 0,
        };
        let partials = objective_invocations(problem.triangles().len());
        let partial_sums = listing.vector(4 * partials as usize);

        let (values, [roots, diagonal]) =
            listing.values.place([hierarchy.roots(), hierarchy.inverse_diagonal()])?;
        let (of_page, [aggregate_of]) = listing.structure.place([hierarchy.aggregate_of()])?;
        let (members_page, [member_starts, members]) =
            listing.structure.place([hierarchy.member_starts(), hierarchy.members()])?;
        let aggregates = hierarchy.member_starts().len() as u32 - 1;
        let right = listing.vector(aggregates as usize);
        let free = problem.free_count() as u32;
        let present_roots = match fitting {
            Fitting::ByHost => NONE,
            Fitting::EachTime => listing.vector(problem.free_count()),
        };
        let fine = FineOp {
            rows: free,
            first: 0,
            free,
            ring_base: 0,
            present_roots,
            unbroken: SUMS,
            partial_sums,
            length: 0.0,
            shape_guard: guard,
            sharpness: 0,
            inverse_penalty_guard: 0.0,
            padding: 0,
        };
        let transfer = TransferOp {
            rows: free,
            first: 0,
            free,
            ring_base: 0,
            aggregate_of,
            member_starts,
            members,
            roots,
            diagonal,
            present_roots,
            right,
            solution: NONE,
        };
        // List an operation on the free vertices, with one dispatch for each part of the one-rings.
        let rings = || mesh.parts.rings.iter().enumerate();
        let fine_by_rings = |listing: &mut Listing<'_>, list: &mut Vec<_>, kernel: Kernel| {
            for (part, RingPart { vertices, entries }) in rings() {
                let (rows, first) = (vertices.end - vertices.start, vertices.start);
                let op = Op::Fine(FineOp { rows, first, ring_base: entries.start, ..fine });
                let bound = Bound::Fine { part };
                list.push(listing.step(kernel.clone(), bound, Groups::ForRows, op)?);
            }
            Ok::<(), GpuError>(())
        };
        let transfer_by_rings =
            |listing: &mut Listing<'_>, list: &mut Vec<_>, kernel: Kernel, op: TransferOp| {
                for (part, RingPart { vertices, entries }) in rings() {
                    let (rows, first) = (vertices.end - vertices.start, vertices.start);
                    let op = TransferOp { rows, first, ring_base: entries.start, ..op };
                    let bound = Bound::Transfer { part, structure: of_page, values };
                    let op = Op::Transfer(op);
                    list.push(listing.step(kernel.clone(), bound, Groups::ForRows, op)?);
                }
                Ok::<(), GpuError>(())
            };

        let mut find_gradient = Vec::new();
        fine_by_rings(&mut listing, &mut find_gradient, Kernel::Gradient(metric))?;
        let mut correction = Vec::new();
        transfer_by_rings(&mut listing, &mut correction, Kernel::SmoothGradient, transfer)?;
        let op = Op::Transfer(TransferOp { rows: aggregates, ..transfer });
        let bound = Bound::Transfer { part: 0, structure: members_page, values };
        correction.push(listing.step(Kernel::Restrict, bound, Groups::ForRows, op)?);
        let solution = listing.solve(hierarchy.levels(), right, &mut correction)?;
        let op = TransferOp { solution, ..transfer };
        transfer_by_rings(&mut listing, &mut correction, Kernel::Prolong, op)?;

        let mut left_out = Vec::new();
        let (whole, everywhere) = (Bound::Fine { part: 0 }, Op::Fine(fine));
        if has_guard {
            // Between V-cycles, `vectors` from SUMS on holds nothing that is still needed.
            listing.vectors = listing.vectors.max(SUMS + free);
            fine_by_rings(&mut listing, &mut left_out, Kernel::FindBroken)?;
            let kernel = Kernel::ExcludeBroken;
            left_out.push(listing.step(kernel, whole, Groups::ForRows, everywhere)?);
        }

        let mut objective = Vec::new();
        for (part, triangles) in mesh.parts.triangles.iter().enumerate() {
            let (rows, first) = (triangles.end - triangles.start, triangles.start);
            let groups = Groups::Just(partials / WORKGROUP);
            objective.push(listing.step(
                Kernel::ObjectiveAlongCorrection(metric),
                Bound::Fine { part },
                groups,
                Op::Fine(FineOp { rows, first, ..fine }),
            )?);
        }
        let op = Op::Coarse(CoarseOp { partial_sums, totals: TOTALS, ..coarse_op(partials) });
        let bound = Bound::Coarse { structure: 0, values: 0 };
        let sum = listing.step(Kernel::SumAlongCorrection, bound, Groups::Just(1), op)?;
        let kernel = Kernel::MoveAlongCorrection;
        let movement = listing.step(kernel, whole, Groups::ForRows, everywhere)?;

        let limits = gpu.device.limits();
        let what = || "the vectors of the coarse levels".to_owned();
        let bytes = u64::from(listing.vectors) * size_of::<[f32; 2]>() as u64;
        let bound = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        check_limit("max_storage_buffer_binding_size", bound, &what, bytes)?;

        let alignment = limits.min_uniform_buffer_offset_alignment;
        let largest = size_of::<FineOp>().max(size_of::<TransferOp>()).max(size_of::<CoarseOp>());
        let stride = (largest as u32).next_multiple_of(alignment);
        let mut ops = vec![0u8; (stride * listing.listed) as usize];
        let listed = find_gradient.iter().chain(&correction).chain(&left_out).chain(&objective);
        for step in listed.chain([&sum, &movement]) {
            let at = (step.number * stride) as usize;
            let op = step.op.bytes();
            ops[at..at + op.len()].copy_from_slice(op);
        }
        let Uploaded { bind_groups, ops, vectors, gradient, direction } =
            listing.upload(mesh, free, &dispatches.params, &ops).await?;
        Ok(Self {
            bind_groups,
            ops,
            stride,
            smoothing: Smoothing::of(0),
            find_gradient,
            correction,
            left_out,
            objective,
            sum,
            movement,
            vectors,
            gradient,
            direction,
        })
    }

    /// Encodes the computation of the gradient from the positions.
    pub(crate) fn encode_gradient(&self, passes: &mut Passes<'_>) {
        self.find_gradient.iter().for_each(|step| self.encode(passes, step));
    }

    /// Encodes one V-cycle: computes the correction from the gradient, or from the vector by which secant pairs replace
    /// the gradient.
    pub(crate) fn encode_cycle(&self, passes: &mut Passes<'_>) {
        self.correction.iter().for_each(|step| self.encode(passes, step));
    }

    /// Encodes the exclusion of vertices from the correction, [`EXCLUSION_PASSES`] times: the vertices of triangles that the
    /// correction would break. With `anew`, the correction is first recomputed without the gradients of these vertices.
    pub(crate) fn encode_left_out(&self, passes: &mut Passes<'_>, anew: bool) {
        let exclude_broken = |passes: &mut Passes<'_>| {
            self.left_out.iter().for_each(|step| self.encode(passes, step));
        };
        if anew {
            exclude_broken(passes);
            self.encode_cycle(passes);
        }
        (0..EXCLUSION_PASSES).for_each(|_| exclude_broken(passes));
    }

    /// Encodes the evaluation of the objective along the correction. `vectors` then begins with the four totals.
    pub(crate) fn encode_objective(&self, passes: &mut Passes<'_>) {
        self.objective.iter().for_each(|step| self.encode(passes, step));
        self.encode(passes, &self.sum);
    }

    /// Encodes the movement of the vertices along the correction.
    pub(crate) fn encode_movement(&self, passes: &mut Passes<'_>) {
        self.encode(passes, &self.movement);
    }

    /// Sets the smoothing of EDGE and the step length along the correction for later submissions. Length 1 is the whole
    /// correction.
    pub(crate) fn set_step(
        &mut self,
        gpu: &Gpu,
        length: f32,
        smoothing: Smoothing,
    ) -> Result<(), GpuError> {
        if self.smoothing != smoothing {
            self.smoothing = smoothing;
            scoped(&gpu.device, || {
                self.find_gradient.iter().for_each(|step| self.write(gpu, step, length));
            })?;
        }
        self.set_length(gpu, length)
    }

    /// Sets the step length along the correction for later submissions.
    pub(crate) fn set_length(&self, gpu: &Gpu, length: f32) -> Result<(), GpuError> {
        scoped(&gpu.device, || {
            let of_length = self.left_out.iter().chain(&self.objective).chain([&self.movement]);
            of_length.for_each(|step| self.write(gpu, step, length));
        })
    }

    fn write(&self, gpu: &Gpu, step: &Dispatch, length: f32) {
        let op = match step.op {
            Op::Fine(op) => Op::Fine(FineOp { length, ..op }.smoothed(self.smoothing)),
            // These operations have neither a length nor a metric.
            Op::Transfer(_) | Op::Coarse(_) => step.op,
        };
        let at = u64::from(step.number * self.stride);
        gpu.queue.write_buffer(&self.ops, at, op.bytes());
    }

    fn encode(&self, passes: &mut Passes<'_>, step: &Dispatch) {
        passes.run(&step.pipeline, None, |pass| {
            let uniform = step.number * self.stride;
            pass.set_bind_group(0, &self.bind_groups[step.bind_group], &[uniform]);
            match step.groups {
                Groups::ForRows => dispatch(pass, step.op.rows()),
                Groups::Just(groups) => pass.dispatch_workgroups(groups, 1, 1),
            }
        });
    }
}
