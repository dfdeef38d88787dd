//! Rates of memory copies, with which sweeps are compared.

use std::time::{Duration, Instant};

use gpu_smooth::{Gpu, wgpu};
use rayon::prelude::*;

/// Bytes per copy, more than caches hold.
const BYTES: u64 = 128 << 20;
/// Largest number of timed calls. The fastest call counts.
const MAX_CALLS: usize = 6;
/// Intended duration of a submission to a GPU, beside which the time to submit and to wait is small.
const SUBMISSION: Duration = Duration::from_millis(20);
/// Largest number of copies in a submission.
const MAX_COPIES: f64 = 64.0;

/// Returns the bytes per second that all cores together read and write in a copy. The first call is always made, and further
/// calls begin within `seconds` seconds.
pub(crate) fn on_cpu(seconds: f64) -> f64 {
    let from = vec![1u8; BYTES as usize];
    let mut to = vec![2u8; BYTES as usize];
    fastest(seconds, 1, || {
        to.par_chunks_mut(1 << 20)
            .zip(from.par_chunks(1 << 20))
            .for_each(|(to, from)| to.copy_from_slice(from));
    })
}

/// Returns the bytes per second that a kernel reads and writes in a copy. The first call is always made, and further calls
/// begin within `seconds` seconds.
pub(crate) fn on_gpu(gpu: &Gpu, seconds: f64) -> f64 {
    let device = gpu.device();
    let bound = device.limits().max_storage_buffer_binding_size;
    let bytes = BYTES.min(bound) & !15;
    let buffer = |usage| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("copy"),
            size: bytes,
            usage,
            mapped_at_creation: false,
        })
    };
    let (from, to) = (buffer(wgpu::BufferUsages::STORAGE), buffer(wgpu::BufferUsages::STORAGE));
    let module = device.create_shader_module(wgpu::include_wgsl!("copy.wgsl"));
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("copy"),
        layout: None,
        module: &module,
        entry_point: Some("copy"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let buffers = [&from, &to];
    let entries = [0, 1].map(|binding| wgpu::BindGroupEntry {
        binding,
        resource: buffers[binding as usize].as_entire_binding(),
    });
    let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("copy"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    });
    let groups = (bytes / 16).div_ceil(256).min(65_535) as u32;
    let copy = |copies: u32| {
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for _ in 0..copies {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bind_group, &[]);
            pass.dispatch_workgroups(groups, 1, 1);
        }
        gpu.queue().submit([encoder.finish()]);
        // On a lost device, nothing is copied; the following measurements report the loss.
        device.poll(wgpu::PollType::wait_indefinitely()).ok();
    };
    let began = Instant::now();
    copy(1);
    let copies = SUBMISSION.as_secs_f64() / began.elapsed().as_secs_f64();
    let copies = copies.clamp(1.0, MAX_COPIES) as u32;
    fastest(seconds, copies, || copy(copies)) * bytes as f64 / BYTES as f64
}

/// Returns the bytes read and written per second in the fastest of several calls: [`MAX_CALLS`], or fewer if `seconds`
/// seconds have passed. Each call makes `copies` copies of [`BYTES`] bytes.
fn fastest(seconds: f64, copies: u32, mut copy: impl FnMut()) -> f64 {
    let began = Instant::now();
    let mut best = Duration::MAX;
    for _ in 0..MAX_CALLS {
        let start = Instant::now();
        copy();
        best = best.min(start.elapsed());
        if began.elapsed().as_secs_f64() >= seconds {
            break;
        }
    }
    2.0 * BYTES as f64 * f64::from(copies) / best.as_secs_f64()
}
