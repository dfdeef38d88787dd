//! The dispatches of a run: kernels for sweeps and for evaluations.

use std::ops::Range;

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::{filled, rows, uniform, zeroed};
use crate::gpu::device::size::{POSITION, objective_invocations, span_count};
use crate::gpu::encode::Passes;
use crate::gpu::kernels::dispatch::dispatch;
use crate::gpu::kernels::form::MeshForm;
use crate::gpu::kernels::layouts::RunBindings;
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{Control, Params, Part, WORKGROUP, pair};
use crate::gpu::mesh::{ElementPart, MeshBuffers, Parts, bounds, of_part};
use crate::gpu::run::slides::Slides;
use crate::gpu::scope::scoped;
use crate::layout::Problem;
use crate::metric::Metric;
use crate::options::Derivatives;
use crate::parallel::pace::pause;
use crate::run::{Plan, StopRule, SweepParams};

/// The dispatches of a plan, bound to a mesh on the device. The methods encode sweeps and evaluations, and submit
/// nothing.
pub(crate) struct Dispatches {
    pub(crate) plan: Plan,
    pub(crate) control: wgpu::Buffer,
    pub(crate) best: wgpu::Buffer,
    pub(crate) params: wgpu::Buffer,
    /// Bind groups by part of the mesh; see [`Parts`].
    bind_groups: Vec<wgpu::BindGroup>,
    sweeps: Vec<(Metric, Derivatives, Pipeline)>,
    /// The pipelines that evaluate the objective, in the order of the parts of elements.
    objectives: Vec<Pipeline>,
    /// The pipeline that adds up partial sums over spans, and the number of spans. `None` if one workgroup adds up all.
    add_up: Option<(Pipeline, u32)>,
    finish: Pipeline,
    keep_best: Option<Pipeline>,
    /// The visits of sliding vertices. `None` if no vertex slides.
    slides: Option<Slides>,
    objective_groups: u32,
    uniforms: Uniforms,
}

/// Uniforms of all dispatches, in this order: sweeps by step, color and part; parts of the elements; parts of the free
/// vertices.
struct Uniforms {
    /// Distinct steps of the run.
    steps: Vec<SweepParams>,
    /// Dispatches of one sweep, ordered by color and part.
    sweep: Vec<ColorPart>,
    elements: Vec<ElementPart>,
    free: Vec<Range<u32>>,
    /// Distance between successive uniforms, in bytes.
    stride: u32,
}

/// Free vertices of one color whose one-rings fit one binding.
struct ColorPart {
    color: u32,
    /// Index of the bind group that holds these one-rings.
    part: usize,
    vertices: Range<u32>,
    ring_base: u32,
}

impl Uniforms {
    fn new(gpu: &Gpu, steps: Vec<SweepParams>, colors: &[Range<u32>], parts: &Parts) -> Self {
        let mut sweep = Vec::new();
        for (color, of_color) in (0..).zip(colors) {
            for (part, ring) in parts.rings.iter().enumerate() {
                let first = of_color.start.max(ring.vertices.start);
                let vertices = first..of_color.end.min(ring.vertices.end);
                if !vertices.is_empty() {
                    sweep.push(ColorPart { color, part, vertices, ring_base: ring.entries.start });
                }
            }
        }
        let alignment = gpu.device.limits().min_uniform_buffer_offset_alignment;
        let stride = alignment.max(size_of::<Part>() as u32);
        let (elements, free) = (parts.elements.clone(), parts.free.clone());
        Self { steps, sweep, elements, free, stride }
    }

    fn bytes(&self) -> Vec<u8> {
        let mut parts = Vec::new();
        for step in &self.steps {
            let of_color = |d: &ColorPart| Part::of_step(step, &d.vertices, d.ring_base);
            parts.extend(self.sweep.iter().map(of_color));
        }
        // The kernels of elements and of free vertices use no parameters of sweeps.
        let of_range = |(first, count): (u32, u32)| Part {
            first,
            count,
            omega: 0.0,
            sharpness: 0,
            shape_guard: 0.0,
            ring_base: 0,
            max_lengthening: 0.0,
            inverse_penalty_guard: 0.0,
        };
        let of_elements = self.elements.iter().map(|part| (part.first, part.count()));
        let of_free = self.free.iter().map(|range| (range.start, range.end - range.start));
        parts.extend(of_elements.chain(of_free).map(of_range));
        let mut bytes = vec![0; parts.len() * self.stride as usize];
        for (part, chunk) in parts.iter().zip(bytes.chunks_exact_mut(self.stride as usize)) {
            chunk[..size_of::<Part>()].copy_from_slice(bytemuck::bytes_of(part));
        }
        bytes
    }

    /// Returns the index of a step's first uniform; `None` for a step outside of the run.
    fn of_step(&self, step: &SweepParams) -> Option<usize> {
        Some(self.steps.iter().position(|known| known == step)? * self.sweep.len())
    }

    fn of_elements(&self) -> usize {
        self.steps.len() * self.sweep.len()
    }

    fn of_free(&self) -> usize {
        self.of_elements() + self.elements.len()
    }
}

/// The buffers of a run that kernels bind beside those of the mesh.
struct BoundRun<'b> {
    params: &'b wgpu::Buffer,
    parts: &'b wgpu::Buffer,
    partial_sums: &'b wgpu::Buffer,
    control: &'b wgpu::Buffer,
    best: &'b wgpu::Buffer,
    /// The parts of the free vertices, if the best positions are kept.
    free: Option<&'b [Range<u32>]>,
}

impl BoundRun<'_> {
    /// Binds a part of the mesh. To be called in an error scope.
    fn bind(&self, gpu: &Gpu, mesh: &MeshBuffers, part: usize) -> wgpu::BindGroup {
        let best_positions = match self.free {
            Some(free) => rows(self.best, of_part(free, part), POSITION),
            None => self.best.as_entire_binding(),
        };
        let bindings = RunBindings {
            params: self.params.as_entire_binding(),
            part: uniform::<Part>(self.parts),
            positions: mesh.bind_positions(),
            ring_start: mesh.ring_start.as_entire_binding(),
            ring: mesh.bind_ring(part),
            triangles: mesh.bind_elements(part),
            partial_sums: self.partial_sums.as_entire_binding(),
            control: self.control.as_entire_binding(),
            best_positions,
        };
        gpu.pipelines.bind(&gpu.device, mesh.parts.form(), bindings)
    }
}

/// Compiles the kernels of all sweeps by `steps`, with a pause after each.
async fn sweep_pipelines(
    gpu: &Gpu,
    form: MeshForm,
    steps: &[SweepParams],
) -> Result<Vec<(Metric, Derivatives, Pipeline)>, GpuError> {
    let mut sweeps: Vec<(Metric, Derivatives, Pipeline)> = Vec::new();
    for &SweepParams { metric, derivatives, .. } in steps {
        if sweeps.iter().all(|known| (known.0, known.1) != (metric, derivatives)) {
            let kernel = Kernel::Sweep(metric, derivatives);
            sweeps.push((metric, derivatives, gpu.pipelines.get(&gpu.device, &kernel, form)?));
            pause().await;
        }
    }
    Ok(sweeps)
}

/// Creates the buffers of a run: `params`, the control, the best positions of `kept` vertices, the uniforms of the dispatches,
/// and room for `sums` pairs of partial sums.
fn buffers(
    gpu: &Gpu,
    params: Params,
    uniforms: &Uniforms,
    kept: u64,
    sums: u64,
) -> Result<[wgpu::Buffer; 5], GpuError> {
    let usage = Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST;
    scoped(&gpu.device, || {
        [
            filled(gpu, "params", &[params], Usage::UNIFORM | Usage::COPY_DST),
            // Zeros mean: not done, nothing evaluated.
            zeroed(gpu, "control", size_of::<Control>() as u64, usage),
            zeroed(gpu, "best positions", kept * POSITION, usage),
            filled(gpu, "parts", &uniforms.bytes(), Usage::UNIFORM),
            zeroed(gpu, "partial sums", sums * size_of::<[f32; 2]>() as u64, Usage::STORAGE),
        ]
    })
}

impl Dispatches {
    /// Creates the pipelines and buffers of a plan whose sweeps use only `steps`. With `keep_best`, each evaluation
    /// copies the positions of a new lowest objective.
    pub(crate) async fn new(
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        plan: Plan,
        steps: Vec<SweepParams>,
        keep_best: bool,
    ) -> Result<Self, GpuError> {
        let form = mesh.parts.form();
        let sweeps = sweep_pipelines(gpu, form, &steps).await?;
        let pipeline = |kernel| gpu.pipelines.get(&gpu.device, &kernel, form);
        let kernel = Kernel::Objective(plan.tracked());
        let mut objectives = Vec::new();
        for part in &mesh.parts.elements {
            objectives.push(gpu.pipelines.get(&gpu.device, &kernel, part.form(form))?);
            pause().await;
        }
        let partials = objective_invocations(problem.judged_count());
        let spans = span_count(partials);
        let add_up = match spans {
            0 => None,
            spans => Some((pipeline(Kernel::AddUpEvaluation(plan.tracked()))?, spans)),
        };
        let finish = pipeline(Kernel::Finish(plan.tracked()))?;
        pause().await;
        let keep_best = keep_best.then(|| pipeline(Kernel::KeepBest)).transpose()?;
        pause().await;

        let sums = (plan.tracked().len() as u64 + 2) * u64::from(partials + spans);
        let kept = if keep_best.is_some() { problem.free_count() as u64 } else { 1 };
        let uniforms = Uniforms::new(gpu, steps.clone(), problem.colors(), &mesh.parts);
        let params = params(problem, &plan, partials);
        let [params, control, best, parts, partial_sums] =
            buffers(gpu, params, &uniforms, kept, sums)?;
        let bind_groups = scoped(&gpu.device, || {
            let bound = BoundRun {
                params: &params,
                parts: &parts,
                partial_sums: &partial_sums,
                control: &control,
                best: &best,
                free: keep_best.as_ref().map(|_| &uniforms.free[..]),
            };
            (0..mesh.parts.count()).map(|part| bound.bind(gpu, mesh, part)).collect()
        })?;
        let slides = match &mesh.curves {
            Some(curves) if !steps.is_empty() => {
                let buffers = [&params, &control];
                Some(Slides::new(gpu, mesh, curves, buffers, steps, keep_best.is_some()).await?)
            }
            _ => None,
        };
        Ok(Self {
            plan,
            control,
            best,
            params,
            bind_groups,
            sweeps,
            objectives,
            add_up,
            finish,
            keep_best,
            slides,
            objective_groups: partials / WORKGROUP,
            uniforms,
        })
    }

    /// Rewrites the uniform of the run for a problem with other targets, and so another mean area.
    pub(crate) fn write_params(&self, gpu: &Gpu, problem: &Problem) -> Result<(), GpuError> {
        let partials = objective_invocations(problem.judged_count());
        let params = params(problem, &self.plan, partials);
        scoped(&gpu.device, || {
            gpu.queue.write_buffer(&self.params, 0, bytemuck::bytes_of(&params));
        })
    }

    /// Encodes one sweep over all colors, and over the sliding vertices, by one of the run's steps.
    pub(crate) fn encode_sweep(&self, passes: &mut Passes<'_>, step: &SweepParams) {
        let key = (step.metric, step.derivatives);
        let pipeline = self.sweeps.iter().find(|known| (known.0, known.1) == key);
        // Both exist, as they were created for every step of the run.
        let (Some((_, _, pipeline)), Some(first)) = (pipeline, self.uniforms.of_step(step)) else {
            debug_assert!(false, "no step of this run: {step:?}");
            return;
        };
        for (i, ColorPart { color, part, vertices, .. }) in self.uniforms.sweep.iter().enumerate() {
            passes.run(pipeline, Some(*color), |pass| {
                self.bind(pass, *part, first + i);
                dispatch(pass, vertices.end - vertices.start);
            });
        }
        if let Some(slides) = &self.slides {
            slides.encode_visits(passes, step);
        }
    }

    /// Encodes the search for sliding vertices that an application has moved since the last sweeps.
    pub(crate) fn encode_take_up(&self, passes: &mut Passes<'_>) {
        if let Some(slides) = &self.slides {
            slides.encode_take_up(passes);
        }
    }

    /// Encodes an evaluation: the sums of the objectives, the stop rule, and the copy of the best positions if the run
    /// keeps them.
    pub(crate) fn encode_evaluation(&self, passes: &mut Passes<'_>) {
        for (part, objective) in self.objectives.iter().enumerate() {
            passes.run(objective, None, |pass| {
                self.bind(pass, part, self.uniforms.of_elements() + part);
                pass.dispatch_workgroups(self.objective_groups, 1, 1);
            });
        }
        if let Some((add_up, spans)) = &self.add_up {
            passes.run(add_up, None, |pass| {
                self.bind(pass, 0, 0);
                pass.dispatch_workgroups(*spans, 1, 1);
            });
        }
        passes.run(&self.finish, None, |pass| {
            self.bind(pass, 0, 0);
            pass.dispatch_workgroups(1, 1, 1);
        });
        let Some(keep_best) = &self.keep_best else { return };
        for (part, vertices) in self.uniforms.free.iter().enumerate() {
            passes.run(keep_best, None, |pass| {
                self.bind(pass, part, self.uniforms.of_free() + part);
                dispatch(pass, vertices.end - vertices.start);
            });
        }
        if let Some(slides) = &self.slides {
            slides.encode_keep_best(passes);
        }
    }

    fn bind(&self, pass: &mut wgpu::ComputePass<'_>, part: usize, uniform: usize) {
        pass.set_bind_group(0, &self.bind_groups[part], &[uniform as u32 * self.uniforms.stride]);
    }
}

/// Returns the constants of a run by a plan.
pub(super) fn params(problem: &Problem, plan: &Plan, partials: u32) -> Params {
    let elements = problem.judged_count() as f64;
    let base = plan.scheme.base();
    let ideal_sum = base.ideal_squared() * elements;
    let goal = plan.stop.goal.map(|f| f * elements - ideal_sum);
    Params {
        zero: 0,
        triangles: problem.judged_count() as u32,
        partials,
        newton_steps: plan.newton_steps,
        base: base as u32,
        window: StopRule::window(&plan.scheme),
        max_sweeps: plan.stop.max_sweeps,
        has_goal: goal.is_some().into(),
        goal_sum: pair(goal.unwrap_or(0.0)),
        ideal_sum: ideal_sum as f32,
        tolerance: plan.stop.tolerance as f32,
        mean_area: pair(problem.mean_area()),
        maps: problem.positions().len() as u32,
        levels_in_plane: problem.are_levels_in_plane().into(),
        size_weight: problem.ideal().size_weight as f32,
        discs: bounds::first_disc(problem),
        least_altitude: problem.least_altitude() as f32,
        padding: 0,
        more_padding: [0; 2],
    }
}
