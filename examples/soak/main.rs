//! Checks that a long-lived process does not accumulate memory, file descriptors or threads. `soak RUNS FRAMES`
//! executes RUNS runs on the GPU engine, every fourth on a device of its own, then FRAMES frames of an application that
//! encodes sweeps itself. The example prints the resources in use ten times, and fails if they grow.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::fs;
use std::time::Instant;

use gpu_smooth::{
    Backend, Gpu, Options, Smoother,
    gpu::{DeviceMesh, Sweeps, VertexBuffer},
    wgpu,
};

/// Returns resources of the process: resident memory in kB, file descriptors, threads. Zeros on systems without
/// `/proc`.
fn in_use() -> [u64; 3] {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let of = |name: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(name));
        line.and_then(|line| line.split_whitespace().next()?.parse().ok()).unwrap_or(0)
    };
    let files = fs::read_dir("/proc/self/fd").map_or(0, |entries| entries.count() as u64);
    [of("VmRSS:"), files, of("Threads:")]
}

/// Calls `once` `count` times. Returns an error if resource usage has grown since the first tenth of the calls.
fn soak(
    what: &str,
    count: usize,
    mut once: impl FnMut(usize) -> Result<(), Box<dyn Error>>,
) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let mut first = None;
    for done in 0..count {
        once(done)?;
        if (done + 1) % count.div_ceil(10) == 0 || done + 1 == count {
            let [memory, files, threads] = in_use();
            let (done, seconds) = (done + 1, start.elapsed().as_secs_f64());
            println!(
                "{done:>8} {what}: {memory} kB, {files} files, {threads} threads, {seconds:.0} s"
            );
            first.get_or_insert([memory, files, threads]);
        }
    }
    let (Some([memory, files, threads]), now) = (first, in_use()) else { return Ok(()) };
    // Memory is freed in steps, so growth by a tenth and two megabytes is tolerated.
    if now[0] > memory + memory / 10 + 2048 || now[1] > files || now[2] > threads {
        return Err(format!("{what}: more is in use than after the first tenth").into());
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut numbers = std::env::args().skip(1).map(|text| text.parse::<usize>());
    let runs = numbers.next().transpose()?.unwrap_or(1000);
    let frames = numbers.next().transpose()?.unwrap_or(10_000);
    let mesh = support::perturb_random(&support::lattice(12, 12), 0.8, 1);
    let smoother = Smoother::new(&mesh)?;
    let backend = Backend::Gpu(Gpu::open(None).block()?);
    let run = |backend: &Backend| smoother.run(&Options::default()).on(backend).block();
    let expected = run(&backend)?.points;
    soak("runs", runs, |done| {
        let points = match done % 4 {
            0 => run(&Backend::Gpu(Gpu::open(None).block()?))?.points,
            _ => run(&backend)?.points,
        };
        if points == expected { Ok(()) } else { Err("other points than the first time".into()) }
    })?;
    let Backend::Gpu(gpu) = &backend else { return Ok(()) };
    let device_mesh = DeviceMesh::new(gpu, &mesh)?;
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block()?;
    let vertices = gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: Some("vertices"),
        size: 8 * mesh.points.len() as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    });
    let bound = device_mesh.bind_vertices(&VertexBuffer::new(vertices.slice(..), 8))?;
    soak("frames", frames, |done| {
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        sweeps.encode_sweeps(&mut encoder, 1);
        bound.encode_export(&mut encoder);
        gpu.queue().submit([encoder.finish()]);
        // Waits like an application with a few frames under way.
        if done % 3 == 2 {
            gpu.device().poll(wgpu::PollType::wait_indefinitely())?;
        }
        Ok(())
    })?;
    println!("f is the same after each run; nothing grew");
    Ok(())
}
