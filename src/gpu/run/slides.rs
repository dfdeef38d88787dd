//! The dispatches of vertices that slide along curves.

use std::ops::Range;

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::{filled, uniform};
use crate::gpu::encode::Passes;
use crate::gpu::kernels::dispatch::dispatch;
use crate::gpu::kernels::layouts::SlideBindings;
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::Part;
use crate::gpu::mesh::{Curves, MeshBuffers};
use crate::gpu::scope::scoped;
use crate::metric::Metric;
use crate::parallel::pace::pause;
use crate::run::SweepParams;

/// The visits of sliding vertices in the sweeps of a run, bound to a mesh. The methods encode dispatches, and submit
/// nothing.
pub(crate) struct Slides {
    bind_group: wgpu::BindGroup,
    visits: Vec<(Metric, Pipeline)>,
    keep_best: Option<Pipeline>,
    /// Finds the parameters of vertices that an application has moved along their curves.
    take_up: Option<Pipeline>,
    /// Distinct steps of the run.
    steps: Vec<SweepParams>,
    colors: Vec<Range<u32>>,
    /// Number of vertices of curves.
    count: u32,
    /// Distance between successive uniforms, in bytes. The uniforms are ordered by step and color.
    stride: u32,
}

impl Slides {
    /// Binds `curves` to the `params` and the `control` of a run that takes `steps`.
    pub(crate) async fn new(
        gpu: &Gpu,
        mesh: &MeshBuffers,
        curves: &Curves,
        [params, control]: [&wgpu::Buffer; 2],
        steps: Vec<SweepParams>,
        keeps_best: bool,
    ) -> Result<Self, GpuError> {
        let form = mesh.parts.form();
        let pipeline = |kernel| gpu.pipelines.get(&gpu.device, &kernel, form);
        let mut visits: Vec<(Metric, Pipeline)> = Vec::new();
        for &SweepParams { metric, .. } in &steps {
            if visits.iter().all(|known| known.0 != metric) {
                visits.push((metric, pipeline(Kernel::Slide(metric))?));
                pause().await;
            }
        }
        let keep_best = keeps_best.then(|| pipeline(Kernel::KeepBestPlaces)).transpose()?;
        pause().await;
        let take_up = curves.is_of_application.then(|| pipeline(Kernel::TakeUp)).transpose()?;
        pause().await;
        let alignment = gpu.device.limits().min_uniform_buffer_offset_alignment;
        let stride = alignment.max(size_of::<Part>() as u32);
        let colors = curves.colors.clone();
        let of_step = |step| colors.iter().map(move |vertices| Part::of_step(step, vertices, 0));
        let parts: Vec<Part> = steps.iter().flat_map(of_step).collect();
        let mut bytes = vec![0; parts.len().max(1) * stride as usize];
        for (part, chunk) in parts.iter().zip(bytes.chunks_exact_mut(stride as usize)) {
            chunk[..size_of::<Part>()].copy_from_slice(bytemuck::bytes_of(part));
        }
        let bind_group = scoped(&gpu.device, || {
            let parts = filled(gpu, "parts of sliding vertices", &bytes, Usage::UNIFORM);
            let bindings = SlideBindings {
                params: params.as_entire_binding(),
                part: uniform::<Part>(&parts),
                positions: mesh.bind_positions(),
                control: control.as_entire_binding(),
                sliding: curves.vertices.as_entire_binding(),
                knots: curves.knots.as_entire_binding(),
                corners: curves.corners.as_entire_binding(),
                places: curves.places.as_entire_binding(),
                best_places: curves.best.as_entire_binding(),
            };
            gpu.pipelines.bind(&gpu.device, form, bindings)
        })?;
        let count = curves.count as u32;
        Ok(Self { bind_group, visits, keep_best, take_up, steps, colors, count, stride })
    }

    /// Encodes a visit of every sliding vertex by one of the run's steps.
    pub(crate) fn encode_visits(&self, passes: &mut Passes<'_>, step: &SweepParams) {
        let pipeline = self.visits.iter().find(|known| known.0 == step.metric);
        let number = self.steps.iter().position(|known| known == step);
        // Both exist, as they were created for every step of the run.
        let (Some((_, pipeline)), Some(number)) = (pipeline, number) else {
            debug_assert!(false, "no step of this run: {step:?}");
            return;
        };
        for (color, vertices) in self.colors.iter().enumerate() {
            let at = (number * self.colors.len() + color) as u32 * self.stride;
            self.run(passes, pipeline, at, vertices.end - vertices.start);
        }
    }

    /// Encodes the copy of the places if the state is the best so far, in a run that keeps the best state.
    pub(crate) fn encode_keep_best(&self, passes: &mut Passes<'_>) {
        if let Some(keep_best) = &self.keep_best {
            self.run(passes, keep_best, 0, self.count);
        }
    }

    /// Encodes the search for vertices that an application has moved since the last sweeps.
    pub(crate) fn encode_take_up(&self, passes: &mut Passes<'_>) {
        if let Some(take_up) = &self.take_up {
            self.run(passes, take_up, 0, self.count);
        }
    }

    fn run(&self, passes: &mut Passes<'_>, pipeline: &Pipeline, at: u32, invocations: u32) {
        passes.run(pipeline, None, |pass| {
            pass.set_bind_group(0, &self.bind_group, &[at]);
            dispatch(pass, invocations);
        });
    }
}
