//! Long lists of partial sums, added up by kernels in two stages and compared with sums in double precision.

use bytemuck::{Pod, Zeroable};
use wgpu::{BufferUsages as Usage, naga};

use super::listing::summing_ops;
use crate::gpu::device::buffers::filled;
use crate::gpu::device::readback;
use crate::gpu::device::size::span_count;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{
    Control, MIN_NORMAL, MOST_SUMMED, Params, SEARCH_STATE, SecantOp, StepOp, StepState, pair,
    unpair,
};
use crate::gpu::{Gpu, Waiting};
use crate::metric::Metric;
use crate::parallel::pace::now;

/// Numbers of partial sums: one stage up to a whole span, and two stages beyond, with spans that end early.
const COUNTS: [u32; 5] = [64, MOST_SUMMED, MOST_SUMMED + 64, 5 * MOST_SUMMED, 65536 - 64];

fn buffer<T: Pod>(gpu: &Gpu, contents: &[T]) -> wgpu::Buffer {
    filled(gpu, "test", contents, Usage::STORAGE | Usage::UNIFORM | Usage::COPY_SRC)
}

/// Returns the constants of a run, of which sums read the zero that a compiler must not know.
fn params(gpu: &Gpu) -> wgpu::Buffer {
    buffer(gpu, &[Params::zeroed()])
}

fn read<T: Pod + Send>(gpu: &Gpu, buffer: &wgpu::Buffer, count: usize) -> Vec<T> {
    now(readback::read(gpu, buffer, count, Waiting::Block)).unwrap()
}

/// Runs a kernel with buffers for its variables of these names.
fn run(gpu: &Gpu, kernel: &Kernel, groups: u32, buffers: &[(&str, &wgpu::Buffer)]) {
    let wgsl = kernel.wgsl();
    let module = naga::front::wgsl::parse_str(&wgsl).unwrap();
    let binding = |name: &str| {
        let found = module.global_variables.iter().find(|(_, of)| of.name.as_deref() == Some(name));
        found.unwrap().1.binding.as_ref().unwrap().binding
    };
    let source = wgpu::ShaderSource::Wgsl(wgsl.as_str().into());
    let descriptor = wgpu::ShaderModuleDescriptor { label: None, source };
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &gpu.device.create_shader_module(descriptor),
        entry_point: Some(kernel.entry_point()),
        compilation_options: Default::default(),
        cache: None,
    });
    let entries: Vec<_> = buffers
        .iter()
        .map(|(name, buffer)| wgpu::BindGroupEntry {
            binding: binding(name),
            resource: buffer.as_entire_binding(),
        })
        .collect();
    let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &bind_group, &[]);
    pass.dispatch_workgroups(groups, 1, 1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
}

/// Returns `lists` lists of `count` numbers, the sum of each, and room for the sums of spans after all lists.
fn lists(lists: u32, count: u32) -> (Vec<[f32; 2]>, Vec<f64>) {
    let number = |k: u32| pair(1.0 + 0.5 * f64::from(k).sin() + f64::from(k % 7));
    let mut all: Vec<[f32; 2]> = (0..lists * count).map(number).collect();
    let sum = |list: &[[f32; 2]]| list.iter().map(|&x| unpair(x)).sum();
    let sums = all.chunks(count as usize).map(sum).collect();
    all.resize((lists * (count + span_count(count))) as usize, [0.0; 2]);
    (all, sums)
}

fn assert_near(found: f64, expected: f64, error: f64, label: &str) {
    assert!((found / expected - 1.0).abs() < error, "{label}: {found} for {expected}");
}

#[test]
fn evaluations_add_up_any_number_of_partial_sums() {
    let gpu = Gpu::open(None).block().unwrap();
    let metrics = vec![Metric::Imr];
    for count in COUNTS {
        // The sum by the metric, the number of inverted triangles, and the worst triangles.
        let (mut values, sums) = lists(3, count);
        let worst = &mut values[2 * count as usize..3 * count as usize];
        for (k, worst) in (0..).zip(&mut *worst) {
            *worst = [(k % 1000) as f32, f32::from_bits(k + MIN_NORMAL)];
        }
        // Of equal values, the lower number is the worst.
        let at = 3 * count as usize / 4;
        (worst[at][0], worst[at + 1][0]) = (1e6, 1e6);
        let params = Params { partials: count, triangles: count, ..Params::zeroed() };
        let params = buffer(&gpu, &[params]);
        let values = buffer(&gpu, &values);
        let control = buffer(&gpu, &[Control::zeroed()]);
        let both = [("params", &params), ("partial_sums", &values)];
        if span_count(count) > 0 {
            run(&gpu, &Kernel::AddUpEvaluation(metrics.clone()), span_count(count), &both);
        }
        let all = [both[0], both[1], ("control", &control)];
        run(&gpu, &Kernel::Finish(metrics.clone()), 1, &all);
        let control: Control = read(&gpu, &control, 1)[0];
        assert_eq!(control.evaluated, 1);
        let found = control.history[0];
        let label = format!("{count} partial sums");
        assert_near(unpair(found[Metric::Imr as usize]), sums[0], 1e-12, &label);
        let [.., inverted, worst] = found;
        assert_near(unpair(inverted), sums[1], 1e-12, &label);
        assert_eq!((worst[0], worst[1].to_bits()), (1e6, at as u32 + MIN_NORMAL), "{label}");
    }
}

#[test]
fn trials_along_a_correction_add_up_any_number_of_partial_sums() {
    let gpu = Gpu::open(None).block().unwrap();
    for count in COUNTS {
        let (values, sums) = lists(4, count);
        let mut vectors = vec![[0.0; 2]; SEARCH_STATE as usize];
        vectors.extend(values);
        let (params, vectors) = (params(&gpu), buffer(&gpu, &vectors));
        for (groups, op) in summing_ops(count, SEARCH_STATE) {
            let op = buffer(&gpu, &[op]);
            let buffers = [("params", &params), ("op", &op), ("vectors", &vectors)];
            run(&gpu, &Kernel::SumAlongCorrection, groups, &buffers);
        }
        for (found, sum) in read::<[f32; 2]>(&gpu, &vectors, 4).into_iter().zip(sums) {
            assert_near(unpair(found), sum, 1e-12, &format!("{count} partial sums"));
        }
    }
}

#[test]
fn inner_products_of_newton_steps_add_up_any_number_of_partial_sums() {
    let gpu = Gpu::open(None).block().unwrap();
    for count in COUNTS {
        let (values, sums) = lists(1, count);
        let (op, fine) = (StepOp { partials: count, ..StepOp::zeroed() }, buffer(&gpu, &values));
        let op = buffer(&gpu, &[op]);
        let state = buffer(&gpu, &[StepState::zeroed()]);
        let params = params(&gpu);
        let buffers = [("params", &params), ("op", &op), ("fine", &fine), ("state", &state)];
        if span_count(count) > 0 {
            run(&gpu, &Kernel::AddUpStep, span_count(count), &buffers[..3]);
        }
        run(&gpu, &Kernel::BeginIteration, 1, &buffers);
        let state: StepState = read(&gpu, &state, 1)[0];
        assert_near(state.rho.into(), sums[0], 1e-7, &format!("{count} partial sums"));
    }
}

#[test]
fn products_of_secant_pairs_add_up_any_number_of_partial_sums() {
    let gpu = Gpu::open(None).block().unwrap();
    for count in COUNTS {
        let (values, sums) = lists(4, count);
        let mut all = vec![[0.0; 2]; 4];
        all.extend(values);
        let all = buffer(&gpu, &all);
        let op = SecantOp { partials: count, pairs: 2, ..SecantOp::zeroed() };
        let op = buffer(&gpu, &[op]);
        let params = params(&gpu);
        let buffers = [("params", &params), ("op", &op), ("sums", &all)];
        if span_count(count) > 0 {
            run(&gpu, &Kernel::AddUpSecants, span_count(count), &buffers);
        }
        run(&gpu, &Kernel::SumSecants, 1, &buffers);
        // The curvature of the newer pair, and the product of the older step and the newer change.
        let scalars: Vec<[f32; 2]> = read(&gpu, &all, 4);
        let label = format!("{count} partial sums");
        assert_near(scalars[0][0].into(), sums[1], 1e-6, &label);
        assert_near(scalars[3][0].into(), sums[3], 1e-6, &label);
    }
}
