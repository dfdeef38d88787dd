//! Coarse levels of a mesh on the device, and the dispatches of a correction.

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::size::{check_limit, objective_invocations};
use crate::gpu::encode::Passes;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{FineOp, NO_GUARD};
use crate::gpu::mesh::MeshBuffers;
use crate::gpu::run::dispatches::Dispatches;
use crate::gpu::run::level_list::LevelList;
use crate::gpu::run::listing::{
    Bound, Dispatch, Groups, Listing, Op, Uploaded, encode, summing_ops, uniforms,
};
use crate::gpu::scope::scoped;
use crate::layout::Problem;
use crate::metric::Smoothing;
use crate::run::multilevel::Hierarchy;
use crate::run::{EXCLUSION_PASSES, Plan};

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
    /// shape guard and a least altitude.
    left_out: Vec<Dispatch>,
    objective: Vec<Dispatch>,
    sums: Vec<Dispatch>,
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

/// Checks that the device has room for a number of vectors in one binding.
fn check_vectors(gpu: &Gpu, count: u32) -> Result<(), GpuError> {
    let limits = gpu.device.limits();
    let what = || "the vectors of the coarse levels".to_owned();
    let bytes = u64::from(count) * size_of::<[f32; 2]>() as u64;
    let bound = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    check_limit("max_storage_buffer_binding_size", bound, &what, bytes)
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
        let has_guard = leaves_out(&dispatches.plan, problem);
        // Compiled here with pauses, so that the listing finds every kernel compiled.
        let kernels = kernels(&dispatches.plan, problem).into_iter();
        let kernels: Vec<_> = kernels.map(|kernel| (kernel, mesh.parts.form())).collect();
        gpu.compile(&kernels).await?;
        let free = problem.free_count() as u32;
        let partials = objective_invocations(problem.judged_count());
        let listing = Listing::new(gpu, mesh.parts.form());
        let is_fitted_each_time = matches!(fitting, Fitting::EachTime);
        let mut list =
            LevelList::new(listing, mesh, hierarchy, is_fitted_each_time, free, partials)?;
        list.fine.shape_guard = guard;
        let find_gradient = list.gradient(metric)?;
        let correction = list.correction()?;
        let left_out = if has_guard { list.left_out()? } else { Vec::new() };
        let objective = list.objective(metric, partials)?;
        let LevelList { mut listing, fine, .. } = list;
        let bound = Bound::Coarse { structure: 0, values: 0 };
        let mut sums = Vec::new();
        for (groups, op) in summing_ops(partials, fine.partial_sums) {
            let (kernel, groups) = (Kernel::SumAlongCorrection, Groups::Just(groups));
            sums.push(listing.step(kernel, bound, groups, Op::Coarse(op))?);
        }
        let (kernel, whole) = (Kernel::MoveAlongCorrection, Bound::Fine { part: 0 });
        let movement = listing.step(kernel, whole, Groups::ForRows, Op::Fine(fine))?;
        check_vectors(gpu, listing.vectors)?;
        let listed = find_gradient.iter().chain(&correction).chain(&left_out).chain(&objective);
        let (stride, ops) = uniforms(gpu, listed.chain(&sums).chain([&movement]), listing.listed);
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
            sums,
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
        self.sums.iter().for_each(|step| self.encode(passes, step));
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
            _ => step.op,
        };
        let at = u64::from(step.number * self.stride);
        gpu.queue.write_buffer(&self.ops, at, op.bytes());
    }

    fn encode(&self, passes: &mut Passes<'_>, step: &Dispatch) {
        encode(passes, &self.bind_groups, self.stride, step);
    }
}

/// Returns whether corrections leave out the triangles around which they break a guard or the least altitude.
fn leaves_out(plan: &Plan, problem: &Problem) -> bool {
    plan.base_step(1.0).shape_guard < NO_GUARD || problem.least_altitude() > 0.0
}

/// Returns the kernels of corrections in a run by a plan.
pub(super) fn kernels(plan: &Plan, problem: &Problem) -> Vec<Kernel> {
    let metric = plan.scheme.base();
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
    if leaves_out(plan, problem) {
        kernels.extend([Kernel::FindBroken, Kernel::ExcludeBroken]);
    }
    // For more than one level, as almost all meshes have.
    kernels.extend([Kernel::Chebyshev, Kernel::MatrixVector]);
    kernels
}
