//! The list of the dispatches of a Newton step.

use bytemuck::Zeroable;
use wgpu::BufferUsages as Usage;

use super::buffers::{Bound, Buffers, PAIR};
use super::nest::{Nest, SlideLists};
use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::{filled, filled_with_pauses, zeroed};
use crate::gpu::device::size::{check_limit, objective_invocations, span_count};
use crate::gpu::kernels::form::MeshForm;
use crate::gpu::kernels::row::InvariantMetric;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{
    FineOp, LatticeOp, NO_GUARD, Params, STEP_TRIALS, StepLine, StepOp, StepState, WORKGROUP,
};
use crate::gpu::mesh::{Curves, ElementPart, MeshBuffers};
use crate::gpu::run::dispatches::{Dispatches, params};
use crate::gpu::run::listing::{Dispatch, Groups, Op, SUMS, along_sums, summing_ops, uniforms};
use crate::gpu::scope::scoped;
use crate::layout::Problem;
use crate::parallel::pace::pause;
use crate::run::multilevel::NONE;
use crate::run::truncated::StepRequest;

/// Number of vectors in `fine`, as in shaders/truncated/vectors.wgsl: five vectors, and inverse blocks of two rows.
const VECTORS: u32 = 7;
/// Bytes of a four-component row.
const ROW: u64 = size_of::<[f32; 4]>() as u64;

/// The dispatches of Newton steps, with their buffers.
pub(super) struct Prepared {
    pub(super) bind_groups: Vec<wgpu::BindGroup>,
    /// Distance between successive uniforms, in bytes.
    pub(super) stride: u32,
    /// Lists of dispatches: the gradient at sliding vertices; the Hessian and the levels; an iteration; the trials of one
    /// submission and the movement.
    pub(super) gradient: Vec<Dispatch>,
    pub(super) set_up: Vec<Dispatch>,
    pub(super) iteration: Vec<Dispatch>,
    pub(super) trials: Vec<Dispatch>,
    pub(super) state: wgpu::Buffer,
    /// The vectors at the vertices.
    pub(super) fine: wgpu::Buffer,
    /// The unknowns of the sliding vertices.
    pub(super) lines: wgpu::Buffer,
    /// The operation on the vertices.
    pub(super) step: StepOp,
    /// `None` if no vertex slides.
    pub(super) slides: Option<SlideLists>,
}

/// The list of the dispatches of Newton steps.
pub(super) struct List<'g> {
    gpu: &'g Gpu,
    form: MeshForm,
    nest: Nest,
    listed: u32,
    /// The operation on the free vertices, with the number of invocations left out.
    step: StepOp,
    gradient: Vec<Dispatch>,
    set_up: Vec<Dispatch>,
    iteration: Vec<Dispatch>,
    trials: Vec<Dispatch>,
}

impl<'g> List<'g> {
    /// Makes the levels, and lists the dispatches with their compiled kernels.
    pub(super) async fn new(
        gpu: &'g Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        dispatches: &Dispatches,
    ) -> Result<Self, GpuError> {
        // Before the levels, which take longer to make than all other lists.
        check(gpu, problem.ring().len() as u64 * ROW)?;
        let curves = mesh.curves.as_ref().map(Curves::set);
        let nest = Nest::new(problem, curves).await;
        let alignment = gpu.device.limits().min_storage_buffer_offset_alignment / PAIR as u32;
        let step = step_op(&nest, problem, alignment.max(1));
        let mut list = Self {
            gpu,
            form: mesh.parts.form(),
            nest,
            listed: 0,
            step,
            gradient: Vec::new(),
            set_up: Vec::new(),
            iteration: Vec::new(),
            trials: Vec::new(),
        };
        let lists = size_of_val(&list.nest.structure[..]) as u64;
        let rows = u64::from(list.nest.rows).max(list.entries()) * ROW;
        check(gpu, list.fine_bytes().max(rows).max(lists))?;
        list.list_set_up(InvariantMetric(dispatches.plan.scheme.base())).await?;
        list.list_iteration().await?;
        list.list_trials(problem, &mesh.parts.elements, dispatches).await?;
        Ok(list)
    }

    fn fine_bytes(&self) -> u64 {
        let StepOp { tangents, vertices, movers, .. } = self.step;
        u64::from(tangents + movers - vertices) * PAIR
    }

    /// Returns the number of blocks of the Hessian.
    fn entries(&self) -> u64 {
        let triangles = self.nest.slides.as_ref().map_or(0, |slides| slides.triangles);
        u64::from(self.step.slide_entries + 2 * triangles)
    }

    async fn dispatch(
        &mut self,
        kernel: Kernel,
        bound: Bound,
        groups: Groups,
        op: Op,
    ) -> Result<Dispatch, GpuError> {
        self.dispatch_in(self.form, kernel, bound, groups, op).await
    }

    async fn dispatch_in(
        &mut self,
        form: MeshForm,
        kernel: Kernel,
        bound: Bound,
        groups: Groups,
        op: Op,
    ) -> Result<Dispatch, GpuError> {
        let pipeline = self.gpu.pipelines.get(&self.gpu.device, &kernel, form)?;
        pause().await;
        let number = self.listed;
        self.listed += 1;
        Ok(Dispatch { pipeline, op, number, bind_group: bound as usize, groups })
    }

    /// Returns the dispatch of a kernel on the free vertices, with a number of invocations.
    async fn step(&mut self, kernel: Kernel, rows: u32) -> Result<Dispatch, GpuError> {
        let op = Op::Step(StepOp { rows, ..self.step });
        self.dispatch(kernel, Bound::Solution, Groups::ForRows, op).await
    }

    /// Returns the dispatch of a kernel whose invocations stride over the free vertices.
    async fn strided(&mut self, kernel: Kernel) -> Result<Dispatch, GpuError> {
        let groups = Groups::Just(self.step.partials / WORKGROUP);
        self.dispatch(kernel, Bound::Solution, groups, Op::Step(self.step)).await
    }

    /// Returns the dispatch of a kernel on the sliding vertices in `groups`, or none if no vertex slides.
    async fn of_slides(
        &mut self,
        kernel: Kernel,
        bound: Bound,
        groups: Groups,
        is_positive: u32,
    ) -> Result<Option<Dispatch>, GpuError> {
        let Some(slides) = &self.nest.slides else { return Ok(None) };
        let rows = slides.vertices.len() as u32;
        let op = Op::Step(StepOp { rows, is_positive, ..self.step });
        self.dispatch(kernel, bound, groups, op).await.map(Some)
    }

    /// Returns the dispatch of a kernel whose invocations stride over the unknowns of sliding vertices.
    async fn strided_slides(&mut self, kernel: Kernel) -> Result<Option<Dispatch>, GpuError> {
        let groups = Groups::Just(self.step.partials / WORKGROUP);
        self.of_slides(kernel, Bound::SlideSolution, groups, 0).await
    }

    /// Returns the dispatch of a kernel in one workgroup.
    async fn single(&mut self, kernel: Kernel) -> Result<Dispatch, GpuError> {
        self.dispatch(kernel, Bound::Solution, Groups::Just(1), Op::Step(self.step)).await
    }

    /// Returns the dispatch that adds up partial sums over spans, or none if one workgroup adds up all.
    async fn add_up(&mut self) -> Result<Option<Dispatch>, GpuError> {
        let spans = span_count(self.step.partials);
        if spans == 0 {
            return Ok(None);
        }
        let (bound, groups) = (Bound::Solution, Groups::Just(spans));
        self.dispatch(Kernel::AddUpStep, bound, groups, Op::Step(self.step)).await.map(Some)
    }

    /// Returns the dispatch of a kernel on the levels.
    async fn lattice(&mut self, kernel: Kernel, op: LatticeOp) -> Result<Dispatch, GpuError> {
        self.dispatch(kernel, Bound::Lattice, Groups::ForRows, Op::Lattice(op)).await
    }

    /// Returns the dispatch of a kernel that judges trials, which has no operation.
    async fn of_trials(&mut self, kernel: Kernel) -> Result<Dispatch, GpuError> {
        self.dispatch(kernel, Bound::Trials, Groups::Just(1), Op::None).await
    }

    /// Lists the positive part of the Hessian and the levels, which follow from it. The Hessian itself then overwrites its positive
    /// part.
    async fn list_set_up(&mut self, metric: InvariantMetric) -> Result<(), GpuError> {
        let StepOp { vertices, .. } = self.step;
        let aggregates = self.nest.op(0).rows;
        let place = Op::Step(StepOp { rows: aggregates, ..self.step });
        let list =
            [self.dispatch(Kernel::PlaceMembers, Bound::Hessian, Groups::ForRows, place).await?];
        self.set_up.extend(list);
        for is_positive in [1, 0] {
            let op = Op::Step(StepOp { rows: vertices, is_positive, ..self.step });
            let kernel = Kernel::FindHessian(metric);
            let hessian = self.dispatch(kernel, Bound::Hessian, Groups::ForRows, op).await?;
            self.set_up.push(hessian);
            let kernel = Kernel::FindSlideHessian(metric);
            let slides =
                self.of_slides(kernel, Bound::SlideHessian, Groups::ForRows, is_positive).await?;
            self.set_up.extend(slides.clone());
            if is_positive == 1 {
                let first = self.step(Kernel::SumOverMembers, aggregates).await?;
                self.set_up.push(first);
                self.list_levels().await?;
            } else {
                self.gradient.extend(slides);
            }
        }
        let (kernel, bound) = (Kernel::ProjectResidual, Bound::SlideSolution);
        let projected = self.of_slides(kernel, bound, Groups::ForRows, 0).await?;
        self.set_up.extend(projected);
        let advance = self.step(Kernel::Advance, aggregates).await?;
        self.set_up.push(advance);
        Ok(())
    }

    /// Lists the matrices of all levels, each computed from the next finer level.
    async fn list_levels(&mut self) -> Result<(), GpuError> {
        for level in 0..self.nest.depth() {
            let op = self.nest.op(level);
            let inverted = self.lattice(Kernel::InvertDiagonal, op).await?;
            self.set_up.push(inverted);
            if level + 1 == self.nest.depth() {
                break;
            }
            let rows = self.nest.op(level + 1).rows;
            for (kernel, rows) in [
                (Kernel::JoinAggregates, rows),
                (Kernel::FindShifts, op.rows),
                (Kernel::SumBlocks, rows),
            ] {
                let dispatch = self.lattice(kernel, LatticeOp { rows, ..op }).await?;
                self.set_up.push(dispatch);
            }
        }
        Ok(())
    }

    /// Lists an iteration of conjugate gradients. The kernel [`Advance`](Kernel::Advance) before the iteration has smoothed the first
    /// level once.
    async fn list_iteration(&mut self) -> Result<(), GpuError> {
        let last = self.nest.depth() - 1;
        let mut list = Vec::new();
        for level in 0..=last {
            // From zero, the residual is the right-hand side.
            let op = self.nest.op(level);
            let op = LatticeOp { left: op.right, ..op };
            list.push(self.lattice(Kernel::SmoothAgain, op).await?);
            if level < last {
                let rows = self.nest.op(level + 1).rows;
                list.push(self.lattice(Kernel::RestrictResidual, LatticeOp { rows, ..op }).await?);
            }
        }
        for level in (0..last).rev() {
            let op = self.nest.op(level);
            for kernel in [Kernel::ProlongMotion, Kernel::SmoothResidual, Kernel::SmoothAgain] {
                list.push(self.lattice(kernel, op).await?);
            }
        }
        list.push(self.strided(Kernel::Precondition).await?);
        list.extend(self.strided_slides(Kernel::PreconditionSlides).await?);
        list.extend(self.add_up().await?);
        list.push(self.single(Kernel::BeginIteration).await?);
        list.push(self.step(Kernel::Turn, self.step.movers).await?);
        list.push(self.strided(Kernel::Multiply).await?);
        list.extend(self.strided_slides(Kernel::MultiplySlides).await?);
        list.extend(self.add_up().await?);
        list.push(self.single(Kernel::JudgeIteration).await?);
        list.push(self.step(Kernel::Advance, self.nest.op(0).rows).await?);
        self.iteration = list;
        Ok(())
    }

    /// Lists the trials of one submission, and the movement.
    async fn list_trials(
        &mut self,
        problem: &Problem,
        elements: &[ElementPart],
        dispatches: &Dispatches,
    ) -> Result<(), GpuError> {
        let metric = dispatches.plan.scheme.base();
        let guard = dispatches.plan.base_step(1.0).shape_guard.min(NO_GUARD) as f32;
        let partials = objective_invocations(problem.judged_count());
        let fine = FineOp {
            rows: 0,
            first: 0,
            free: self.step.movers,
            ring_base: 0,
            present_roots: NONE,
            unbroken: NONE,
            partial_sums: SUMS,
            // The length is in the state of the search.
            length: 0.0,
            shape_guard: guard,
            sharpness: 0,
            inverse_penalty_guard: 0.0,
            padding: 0,
        };
        let whole = Groups::Just(partials / WORKGROUP);
        let movement = FineOp { rows: self.step.vertices, ..fine };
        let begin = self.of_trials(Kernel::BeginTrials).await?;
        let mut evaluation = Vec::new();
        // Each list of elements is one part, as a Hessian that fits one binding is larger.
        for (part, bound) in elements.iter().zip([Bound::Fine, Bound::FineOfQuadrilaterals]) {
            let kernel = Kernel::ObjectiveAlongCorrection(metric);
            let op = Op::Fine(FineOp { rows: part.count(), first: part.first, ..fine });
            let form = part.form(self.form);
            evaluation.push(self.dispatch_in(form, kernel, bound, whole, op).await?);
        }
        for (groups, op) in summing_ops(partials, SUMS) {
            let (kernel, groups) = (Kernel::SumAlongCorrection, Groups::Just(groups));
            evaluation.push(self.dispatch(kernel, Bound::Coarse, groups, Op::Coarse(op)).await?);
        }
        evaluation.push(self.of_trials(Kernel::JudgeLength).await?);
        let kernel = Kernel::MoveAlongCorrection;
        let op = Op::Fine(movement);
        let movement = self.dispatch(kernel, Bound::Fine, Groups::ForRows, op).await?;
        self.trials.push(begin);
        // The host places sliding vertices before each trial.
        let trials = if self.nest.slides.is_some() { 1 } else { STEP_TRIALS };
        for _ in 0..trials {
            self.trials.extend(evaluation.iter().cloned());
        }
        self.trials.push(movement);
        Ok(())
    }

    /// Creates the buffers, and the bind groups of the listed dispatches.
    pub(super) async fn bound(
        self,
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        dispatches: &Dispatches,
    ) -> Result<Prepared, GpuError> {
        let (fine_bytes, entries) = (self.fine_bytes(), self.entries());
        let Self { form, nest, listed, step, gradient, set_up, iteration, trials, .. } = self;
        let all = set_up.iter().chain(&iteration).chain(&trials);
        let (stride, ops) = uniforms(gpu, all, listed);
        let structure =
            filled_with_pauses(gpu, "step structure", &[&nest.structure], Usage::STORAGE).await?;
        let (bind_groups, buffers) = scoped(&gpu.device, || {
            let partials = objective_invocations(problem.judged_count());
            // The solution is in the coordinates of the plane.
            let params =
                Params { levels_in_plane: 1, ..params(problem, &dispatches.plan, partials) };
            let storage = |label, size: u64| zeroed(gpu, label, size, Usage::STORAGE);
            // The gradient at the sliding vertices comes before their tangents are known.
            let unknown = |&vertex: &u32| StepLine { vertex, next: NONE, ..StepLine::zeroed() };
            let slides = nest.slides.iter().flat_map(|slides| &slides.vertices);
            let mut lines: Vec<StepLine> = slides.map(unknown).collect();
            // An empty buffer cannot be bound.
            lines.resize(lines.len().max(1), StepLine::zeroed());
            let written = Usage::STORAGE | Usage::COPY_DST;
            let copied = Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST;
            let buffers = Buffers {
                params: filled(gpu, "step params", &[params], Usage::UNIFORM),
                ops: filled(gpu, "step operations", &ops, Usage::UNIFORM),
                structure,
                entries: storage("Hessian", entries * ROW),
                fine: zeroed(gpu, "step vectors", fine_bytes, copied),
                rows: storage("step rows", u64::from(nest.rows) * ROW),
                vectors: storage("step sums", u64::from(SUMS + along_sums(partials)) * PAIR),
                state: zeroed(gpu, "step state", size_of::<StepState>() as u64, copied),
                lines: filled(gpu, "unknowns of sliding vertices", &lines, written),
                nothing: storage("no values", PAIR),
            };
            (buffers.bind_groups(gpu, form, mesh, &step), buffers)
        })?;
        Ok(Prepared {
            bind_groups,
            stride,
            gradient,
            set_up,
            iteration,
            trials,
            state: buffers.state,
            fine: buffers.fine,
            lines: buffers.lines,
            step,
            slides: nest.slides,
        })
    }
}

/// Returns [`GpuError::Limit`] if a buffer of this number of bytes is larger than a binding.
fn check(gpu: &Gpu, needed: u64) -> Result<(), GpuError> {
    let limits = gpu.device.limits();
    let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    let what = || "the Hessian and the levels of Newton steps".to_owned();
    check_limit("max_storage_buffer_binding_size", most, &what, needed)
}

/// Returns the operation on the vertices and the first level of aggregates. Vectors begin at multiples of `alignment`.
fn step_op(nest: &Nest, problem: &Problem, alignment: u32) -> StepOp {
    let [aggregate_of, member_starts, members] = nest.of_vertices;
    let first = nest.op(0);
    let (free, all) = (problem.free_count() as u32, problem.positions().len() as u32);
    let movers = if nest.slides.is_some() { all } else { free };
    let vector = movers.next_multiple_of(alignment);
    let partials = objective_invocations(free as usize);
    let of_slides = |of: fn(&SlideLists) -> u32| nest.slides.as_ref().map_or(0, of);
    StepOp {
        rows: free,
        vertices: free,
        ring_base: 0,
        vector,
        partials,
        is_positive: 0,
        aggregate_of,
        member_starts,
        members,
        starts: first.starts,
        columns: first.columns,
        blocks: first.blocks,
        inverses: first.inverses,
        extents: first.extents,
        right: first.right,
        step: first.step,
        solution: first.solution,
        movers,
        corner_starts: of_slides(|slides| slides.corner_starts),
        corners: of_slides(|slides| slides.corners),
        slide_entries: problem.ring().len() as u32,
        tangents: VECTORS * vector + partials + span_count(partials) + StepRequest::MOST_ITERATIONS,
        padding: [0; 2],
    }
}
