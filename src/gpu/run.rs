//! The dispatches of a run: which kernels a sweep and an evaluation take.

use std::ops::Range;

use wgpu::BufferUsages as Usage;

use super::buffers::{MeshBuffers, filled, zeroed};
use super::device::{Gpu, GpuError, scoped};
use super::kernel::Pipeline;
use super::layout::{Control, Params, SweepColor, WORKGROUP, pair};
use super::passes::Passes;
use super::shaders::{Interface, Kernel};
use crate::metric::Metric;
use crate::multilevel::OMEGAS;
use crate::plan::{Plan, Sharpness, StopRule};
use crate::problem::Problem;

/// Workgroups along x of a dispatch too long for one dimension.
pub(crate) const FOLD: u32 = 32768;

/// A plan bound to a mesh on the device: encodes sweeps and evaluations, submits nothing.
pub(crate) struct Run {
    pub(crate) plan: Plan,
    pub(crate) control: wgpu::Buffer,
    pub(crate) best: wgpu::Buffer,
    pub(crate) params: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    sweeps: Vec<(Metric, Pipeline)>,
    objective: Pipeline,
    finish: Pipeline,
    keep_best: Option<Pipeline>,
    objective_groups: u32,
    colors: Vec<Range<u32>>,
    steps: Steps,
}

/// Every different way a sweep of the plan steps, in the order of its uniforms.
struct Steps {
    known: Vec<(f32, u32)>,
    /// Bytes from one uniform to the next.
    stride: u32,
}

impl Steps {
    fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let Sharpness { first, last, .. } = plan.sharpness;
        let mut known = Vec::new();
        for &metric in plan.scheme.metrics() {
            let corrected = OMEGAS.map(|omega| omega as f32);
            let own = plan.omega[metric as usize] as f32;
            for omega in [1.0, own].into_iter().chain(corrected) {
                for sharpness in first..=last.max(first) {
                    if !known.contains(&(omega, sharpness)) {
                        known.push((omega, sharpness));
                    }
                }
            }
        }
        let alignment = gpu.device.limits().min_uniform_buffer_offset_alignment;
        Self { known, stride: alignment.max(size_of::<SweepColor>() as u32) }
    }

    /// Over-relaxation and sharpness of a sweep.
    fn of(plan: &Plan, sweep: u32) -> (f32, u32) {
        (plan.omega(plan.scheme.metric(sweep), sweep) as f32, plan.sharpness.of(sweep))
    }

    /// The uniforms: by step, then by color.
    fn uniforms(&self, colors: &[Range<u32>]) -> Vec<u8> {
        let stride = self.stride as usize;
        let mut bytes = vec![0; self.known.len() * colors.len() * stride];
        let mut chunks = bytes.chunks_exact_mut(stride);
        for &(omega, sharpness) in &self.known {
            for (range, chunk) in colors.iter().zip(&mut chunks) {
                let count = range.end - range.start;
                let uniform = SweepColor { first: range.start, count, omega, sharpness };
                chunk[..size_of::<SweepColor>()].copy_from_slice(bytemuck::bytes_of(&uniform));
            }
        }
        bytes
    }
}

impl Run {
    /// Makes the pipelines and buffers of a plan. Without `keep_best` the state of interest is always
    /// the last.
    pub(crate) fn new(
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        plan: Plan,
        keep_best: bool,
    ) -> Result<Self, GpuError> {
        let pipeline = |kernel| gpu.pipelines.get(&gpu.device, &kernel);
        let mut sweeps: Vec<(Metric, Pipeline)> = Vec::new();
        for &metric in plan.scheme.metrics() {
            if sweeps.iter().all(|&(known, _)| known != metric) {
                sweeps.push((
                    metric,
                    pipeline(Kernel::Sweep(metric, plan.derivatives[metric as usize]))?,
                ));
            }
        }
        let objective = pipeline(Kernel::Objective(plan.tracked()))?;
        let finish = pipeline(Kernel::Finish(plan.tracked()))?;
        let keep_best = keep_best.then(|| pipeline(Kernel::KeepBest)).transpose()?;

        let objective_groups = objective_groups(problem);
        let partials = objective_groups * WORKGROUP;
        let partial_bytes =
            (plan.tracked().len() as u64 + 2) * u64::from(partials) * size_of::<[f32; 2]>() as u64;
        let kept = if keep_best.is_some() { problem.free_count() as u64 } else { 1 };
        let steps = Steps::new(gpu, &plan);
        let params = params(problem, &plan, partials);
        let uniforms = steps.uniforms(problem.colors());

        let (control, best, params, bind_group) = scoped(&gpu.device, || {
            let params = filled(gpu, "params", &[params], Usage::UNIFORM);
            let steps = filled(gpu, "sweep colors", &uniforms, Usage::UNIFORM);
            let partial_sums = zeroed(gpu, "partial sums", partial_bytes, Usage::STORAGE);
            // Zeros: not done, nothing evaluated.
            let control = zeroed(
                gpu,
                "control",
                size_of::<Control>() as u64,
                Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST,
            );
            let best_bytes = kept * size_of::<[f32; 4]>() as u64;
            let best = zeroed(gpu, "best positions", best_bytes, Usage::STORAGE | Usage::COPY_SRC);
            let step = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &steps,
                offset: 0,
                size: wgpu::BufferSize::new(size_of::<SweepColor>() as u64),
            });
            let resources = [
                params.as_entire_binding(),
                step,
                mesh.positions.as_entire_binding(),
                mesh.ring_start.as_entire_binding(),
                mesh.ring.as_entire_binding(),
                mesh.triangles.as_entire_binding(),
                partial_sums.as_entire_binding(),
                control.as_entire_binding(),
                best.as_entire_binding(),
            ];
            let bind_group = gpu.pipelines.bind(&gpu.device, Interface::Run, &resources);
            (control, best, params, bind_group)
        })?;
        let colors = problem.colors().to_vec();
        Ok(Self {
            plan,
            control,
            best,
            params,
            bind_group,
            sweeps,
            objective,
            finish,
            keep_best,
            objective_groups,
            colors,
            steps,
        })
    }

    /// One sweep over all colors; sweeps count from 1.
    pub(crate) fn encode_sweep(&self, passes: &mut Passes<'_>, sweep: u32) {
        let step = Steps::of(&self.plan, sweep);
        self.encode_step(passes, self.plan.scheme.metric(sweep), step);
    }

    /// One sweep with the base metric, over-relaxed as a multilevel run wants it.
    pub(crate) fn encode_relaxed_sweep(&self, passes: &mut Passes<'_>, omega: f64) {
        let step = (omega as f32, self.plan.sharpness.last);
        self.encode_step(passes, self.plan.scheme.base(), step);
    }

    fn encode_step(&self, passes: &mut Passes<'_>, metric: Metric, step: (f32, u32)) {
        let pipeline = self.sweeps.iter().find(|&&(known, _)| known == metric);
        let step = self.steps.known.iter().position(|&known| known == step);
        // Both were made for every sweep of the plan.
        let (Some((_, pipeline)), Some(step)) = (pipeline, step) else { return };
        let first = (step * self.colors.len()) as u32;
        for (color, range) in (0..).zip(&self.colors) {
            passes.run(pipeline, Some(color), |pass| {
                let uniform = (first + color) * self.steps.stride;
                pass.set_bind_group(0, &self.bind_group, &[uniform]);
                dispatch(pass, range.end - range.start);
            });
        }
    }

    /// Evaluates the objectives, judges, and keeps the positions if they are the best.
    pub(crate) fn encode_evaluation(&self, passes: &mut Passes<'_>) {
        let bind = |pass: &mut wgpu::ComputePass<'_>| {
            pass.set_bind_group(0, &self.bind_group, &[0]);
        };
        passes.run(&self.objective, None, |pass| {
            bind(pass);
            pass.dispatch_workgroups(self.objective_groups, 1, 1);
        });
        passes.run(&self.finish, None, |pass| {
            bind(pass);
            pass.dispatch_workgroups(1, 1, 1);
        });
        if let Some(keep_best) = &self.keep_best {
            passes.run(keep_best, None, |pass| {
                bind(pass);
                dispatch(pass, self.colors.last().map_or(0, |range| range.end));
            });
        }
    }
}

/// Workgroups of a sum over the triangles: few enough invocations to end it in one workgroup, enough to
/// fill a large GPU.
pub(crate) fn objective_groups(problem: &Problem) -> u32 {
    (problem.triangles().len() as u32).div_ceil(2048).clamp(1, 1024)
}

fn params(problem: &Problem, plan: &Plan, partials: u32) -> Params {
    let triangles = problem.triangles().len() as f64;
    let base = plan.scheme.base();
    let ideal_sum = base.ideal_squared() * triangles;
    let target = plan.stop.target.map(|f| f * triangles - ideal_sum);
    Params {
        zero: 0,
        triangles: problem.triangles().len() as u32,
        partials,
        inner: plan.inner,
        base: base as u32,
        window: StopRule::window(&plan.scheme),
        max_sweeps: plan.stop.max_sweeps,
        has_target: target.is_some().into(),
        target_sum: pair(target.unwrap_or(0.0)),
        ideal_sum: ideal_sum as f32,
        tolerance: plan.stop.tolerance as f32,
        mean_area: problem.mean_area() as f32,
        padding: 0,
    }
}

/// Dispatches enough workgroups for `invocations`, folded where one dimension is too short.
pub(crate) fn dispatch(pass: &mut wgpu::ComputePass<'_>, invocations: u32) {
    let groups = invocations.div_ceil(WORKGROUP);
    if groups <= FOLD {
        pass.dispatch_workgroups(groups, 1, 1);
    } else {
        pass.dispatch_workgroups(FOLD, groups.div_ceil(FOLD), 1);
    }
}
