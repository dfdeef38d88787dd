//! A mesh on the device.

use glam::DVec2;
use wgpu::util::DeviceExt;

use super::device::{Gpu, GpuError, scoped};
use super::layout::{Color, Control, Params, WORKGROUP, pair, unpair};
use crate::metric::Metric;
use crate::plan::{Plan, StopRule};
use crate::problem::Problem;

/// The buffers of one run, bound together.
pub(crate) struct Buffers {
    pub(crate) positions: wgpu::Buffer,
    pub(crate) best: wgpu::Buffer,
    pub(crate) control: wgpu::Buffer,
    pub(crate) bind_group: wgpu::BindGroup,
    /// Bytes from one color's uniform to the next.
    pub(crate) color_stride: u32,
    /// Workgroups of the objective kernel.
    pub(crate) objective_groups: u32,
}

impl Buffers {
    /// Uploads a problem with its vertices at `positions`.
    pub(crate) fn new(
        gpu: &Gpu,
        problem: &Problem,
        positions: &[DVec2],
        plan: &Plan,
    ) -> Result<Self, GpuError> {
        let limits = gpu.device.limits();
        let position_bytes = size_of::<[f32; 4]>() as u64 * positions.len() as u64;
        let triangle_bytes = size_of::<[u32; 3]>() as u64 * problem.triangles().len() as u64;
        let ring_bytes = size_of::<u32>() as u64 * problem.ring().len() as u64;
        // Checked before anything is allocated: a limit met halfway helps nobody.
        for (what, needed) in [
            ("the buffer of vertex positions", position_bytes),
            ("the buffer of triangles", triangle_bytes),
            ("the buffer of one-rings", ring_bytes),
        ] {
            let binding = limits.max_storage_buffer_binding_size;
            for (limit, available) in [
                ("max_storage_buffer_binding_size", binding),
                ("max_buffer_size", limits.max_buffer_size),
            ] {
                if needed > available {
                    let what = format!("{what} ({} vertices)", positions.len());
                    return Err(GpuError::Limit { what, needed, limit, available });
                }
            }
        }
        // Few enough invocations to end the sum in one workgroup, enough to fill a large GPU.
        let objective_groups = (problem.triangles().len() as u32).div_ceil(2048).clamp(1, 1024);
        let partials = objective_groups * WORKGROUP;
        let tracked = plan.tracked().len() as u64;
        let color_stride =
            limits.min_uniform_buffer_offset_alignment.max(size_of::<Color>() as u32);

        let positions: Vec<[f32; 4]> = positions.iter().map(|&p| split(p)).collect();
        let mut colors = vec![0u8; problem.colors().len() * color_stride as usize];
        for (chunk, range) in colors.chunks_exact_mut(color_stride as usize).zip(problem.colors()) {
            let color = Color { first: range.start, count: range.end - range.start };
            chunk[..size_of::<Color>()].copy_from_slice(bytemuck::bytes_of(&color));
        }
        let params = params(problem, plan, partials);

        use wgpu::BufferUsages as Usage;
        let device = &gpu.device;
        scoped(device, || {
            let filled = |label: &str, contents: &[u8], usage: Usage| {
                let label = Some(label);
                device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                    label,
                    contents,
                    usage,
                })
            };
            let empty = |label: &str, size: u64, usage: Usage| {
                device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some(label),
                    size,
                    usage,
                    mapped_at_creation: false,
                })
            };
            let readable = Usage::STORAGE | Usage::COPY_SRC;
            let bytes = bytemuck::cast_slice::<[f32; 4], u8>(&positions);
            let kept = if plan.is_monotone() { 1 } else { problem.free_count() as u64 };
            let best_bytes = size_of::<[f32; 4]>() as u64 * kept;
            let pair_bytes = size_of::<[f32; 2]>() as u64;

            let params = filled("gpu-smooth params", bytemuck::bytes_of(&params), Usage::UNIFORM);
            let colors = filled("gpu-smooth colors", &colors, Usage::UNIFORM);
            let positions = filled("gpu-smooth positions", bytes, readable);
            let ring_start = bytemuck::cast_slice(problem.ring_start());
            let ring_start = filled("gpu-smooth ring starts", ring_start, Usage::STORAGE);
            let ring = bytemuck::cast_slice(problem.ring());
            let ring = filled("gpu-smooth one-rings", ring, Usage::STORAGE);
            let triangles = bytemuck::cast_slice(problem.triangles());
            let triangles = filled("gpu-smooth triangles", triangles, Usage::STORAGE);
            let partial_bytes = tracked * u64::from(partials) * pair_bytes;
            let partial_sums = empty("gpu-smooth partial sums", partial_bytes, Usage::STORAGE);
            // New buffers are zero: not done, nothing evaluated.
            let control = empty("gpu-smooth control", size_of::<Control>() as u64, readable);
            let best = empty("gpu-smooth best positions", best_bytes, readable);

            let color = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &colors,
                offset: 0,
                size: wgpu::BufferSize::new(size_of::<Color>() as u64),
            });
            let resources = [
                params.as_entire_binding(),
                color,
                positions.as_entire_binding(),
                ring_start.as_entire_binding(),
                ring.as_entire_binding(),
                triangles.as_entire_binding(),
                partial_sums.as_entire_binding(),
                control.as_entire_binding(),
                best.as_entire_binding(),
            ];
            let entries: Vec<_> = resources
                .into_iter()
                .zip(0..)
                .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource })
                .collect();
            let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("gpu-smooth mesh"),
                layout: &gpu.pipelines.bindings,
                entries: &entries,
            });
            Self { positions, best, control, bind_group, color_stride, objective_groups }
        })
    }
}

fn params(problem: &Problem, plan: &Plan, partials: u32) -> Params {
    let triangles = problem.triangles().len() as f64;
    let base = plan.scheme.base();
    let ideal_sum = base.ideal_squared() * triangles;
    let target = plan.stop.target.map(|f| f * triangles - ideal_sum);
    let mut omega = [[0.0; 4]; 2];
    for &metric in Metric::ALL {
        let index = metric as usize;
        omega[index / 4][index % 4] = plan.omega[index] as f32;
    }
    Params {
        zero: 0,
        triangles: problem.triangles().len() as u32,
        partials,
        plain_sweeps: plan.plain_sweeps,
        inner: plan.inner,
        sharpness_first: plan.sharpness.first,
        sharpness_every: plan.sharpness.every,
        sharpness_last: plan.sharpness.last.max(plan.sharpness.first),
        base: base as u32,
        window: StopRule::window(&plan.scheme),
        max_sweeps: plan.stop.max_sweeps,
        has_target: target.is_some().into(),
        target_sum: pair(target.unwrap_or(0.0)),
        ideal_sum: ideal_sum as f32,
        tolerance: plan.stop.tolerance as f32,
        mean_area: problem.mean_area() as f32,
        padding: [0; 3],
        omega,
    }
}

/// A position as pairs of floats, laid out xy + zw.
pub(crate) fn split(p: DVec2) -> [f32; 4] {
    let ([x, x_low], [y, y_low]) = (pair(p.x), pair(p.y));
    [x, y, x_low, y_low]
}

/// The position that [`split`] gave or the device moved.
pub(crate) fn join([x, y, x_low, y_low]: [f32; 4]) -> DVec2 {
    DVec2::new(unpair([x, x_low]), unpair([y, y_low]))
}
