//! Frames of an application: time to encode a frame, time from its submission until the device is done, and time to
//! prepare a mesh for frames.
//!
//! `cargo bench --bench frames -- [VERTICES...]`, 2,000, 20,000 and 200,000 by default. A frame consists of an import,
//! three sweeps, the objective and the export; `corrected` adds three corrections from coarser levels. `valid` adds
//! five untangling sweeps, which find no inverted triangle. `all` adds a mask, a move of the hole, the last valid
//! positions and two readbacks, and its sweeps end by themselves. The minimum follows each median. The variable
//! `GPU_SMOOTH_ADAPTER` names the adapter; the default is the best.

#![allow(clippy::print_stdout)]

use std::time::{Duration, Instant};

use gpu_smooth::{
    Gpu, Method, Options, Smoother, Topology,
    gpu::{DeviceMesh, ObjectiveValues, Readback, Sweeps, UntanglingSweeps, VertexBuffer},
    topology::signed_area,
    wgpu::{self, BufferUsages as Usage},
};

/// Number of measured frames, after an equal number of unmeasured ones.
const FRAMES: usize = 50;
/// Number of preparations of a mesh.
const MESHES: usize = 10;

fn main() {
    let sizes: Vec<usize> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    let sizes = if sizes.is_empty() { vec![2000, 20_000, 200_000] } else { sizes };
    let outline = support::Outline::parse(include_str!("../meshes/plate.outline")).unwrap();
    let adapter = std::env::var("GPU_SMOOTH_ADAPTER").ok();
    let gpu = Gpu::open(adapter.as_deref()).block().unwrap();
    println!("{}: medians (and the least)", gpu.adapter().name);
    for vertices in sizes {
        let mesh = support::triangulate(&outline, vertices).unwrap();
        let buffer = |size: usize, usage| {
            gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: size as u64,
                usage,
                mapped_at_creation: false,
            })
        };
        let count = mesh.points.len();
        let usage = Usage::STORAGE | Usage::COPY_DST | Usage::COPY_SRC;
        let vertex_buffer = buffer(8 * count, usage);
        let points: Vec<[f32; 2]> = mesh.points.iter().map(|p| p.map(|x| x as f32)).collect();
        gpu.queue().write_buffer(&vertex_buffer, 0, bytemuck::cast_slice(&points));
        let numbers = buffer(size_of::<ObjectiveValues>() + 4, usage);
        let smoother = Smoother::new(&mesh).unwrap();
        let [mut made, mut taken] = [Vec::new(), Vec::new()];
        for _ in 0..MESHES {
            let start = Instant::now();
            let device_mesh = DeviceMesh::new(&gpu, &mesh).unwrap();
            made.push(start.elapsed());
            drop(device_mesh);
            let start = Instant::now();
            let device_mesh = smoother.to_device(&gpu).unwrap();
            taken.push(start.elapsed());
            drop(device_mesh);
        }
        for (how, times) in [("made ready", made), ("taken from a smoother", taken)] {
            let [time, least] = middle_and_least(times).map(|time| 1e3 * time.as_secs_f64());
            println!("{vertices:>7} {how}: {time:.2} ms ({least:.2})");
        }
        let device_mesh = DeviceMesh::new(&gpu, &mesh).unwrap();
        let bound =
            device_mesh.bind_vertices(&VertexBuffer::new(vertex_buffer.slice(..), 8)).unwrap();

        let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
        let objective = sweeps.bind_objective(numbers.slice(..)).unwrap();
        let plain = times(&gpu, |encoder| {
            bound.encode_import(encoder);
            sweeps.encode_sweeps(encoder, 3);
            objective.encode_objective(encoder);
            bound.encode_export(encoder);
        });

        let options = Options::default().method(Method::Multilevel);
        let mut corrected_sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
        let corrected_objective = corrected_sweeps.bind_objective(numbers.slice(..)).unwrap();
        let corrected = times(&gpu, |encoder| {
            bound.encode_import(encoder);
            corrected_sweeps.encode_sweeps(encoder, 3);
            corrected_objective.encode_objective(encoder);
            bound.encode_export(encoder);
        });

        let untangling = UntanglingSweeps::new(&device_mesh).unwrap();
        let valid = times(&gpu, |encoder| {
            bound.encode_import(encoder);
            untangling.encode_untangle(encoder, 5);
            sweeps.encode_sweeps(encoder, 3);
            objective.encode_objective(encoder);
            bound.encode_export(encoder);
        });

        let mut sweeps =
            Sweeps::until_converged(&device_mesh, &Options::default()).block().unwrap();
        let objective = sweeps.bind_objective(numbers.slice(..)).unwrap();
        let mask = buffer(4 * count, usage);
        let mask = device_mesh.bind_mask(mask.slice(..)).unwrap();
        let mut loops = Topology::new(&mesh).unwrap().boundary_loops();
        loops.retain(|vertices| signed_area(&mesh.points, vertices) < 0.0);
        let hole = loops.swap_remove(0);
        let targets = buffer(8 * hole.len(), usage);
        let to: Vec<[f32; 2]> = hole.iter().map(|&v| points[v as usize].map(|x| x + 0.1)).collect();
        gpu.queue().write_buffer(&targets, 0, bytemuck::cast_slice(&to));
        let share = numbers.slice(size_of::<ObjectiveValues>() as u64..);
        let drag = device_mesh
            .bind_move(&hole, &VertexBuffer::new(targets.slice(..), 8), 8.0, share)
            .unwrap();
        let last_valid = device_mesh.keep_last_valid().unwrap();
        let mut values = Readback::<ObjectiveValues>::new(&gpu, numbers.slice(..), 1).unwrap();
        let mut positions =
            Readback::<[f32; 2]>::new(&gpu, vertex_buffer.slice(..), count).unwrap();
        let all = times(&gpu, |encoder| {
            bound.encode_import(encoder);
            mask.encode_mask(encoder);
            drag.encode_move(encoder);
            sweeps.encode_sweeps(encoder, 3);
            last_valid.encode_restore_last_valid(encoder);
            objective.encode_objective(encoder);
            bound.encode_export(encoder);
            values.encode_readback(encoder);
            positions.encode_readback(encoder);
            // Results that have arrived are taken, which frees their buffers; positions are copied.
            let _ = (values.latest().unwrap(), positions.latest().unwrap());
        });
        let kinds = [("plain", plain), ("corrected", corrected), ("valid", valid), ("all", all)];
        for (name, [encode, frame]) in kinds {
            let encode = encode.map(|time| 1e6 * time.as_secs_f64());
            let frame = frame.map(|time| 1e3 * time.as_secs_f64());
            println!(
                "{vertices:>7} {name:>9}: encode {:6.1} µs ({:6.1}), frame {:8.2} ms ({:8.2})",
                encode[0], encode[1], frame[0], frame[1],
            );
        }
    }
}

/// Returns the time to encode a frame, and the time until the device is done: median and minimum of each.
fn times(gpu: &Gpu, mut encode: impl FnMut(&mut wgpu::CommandEncoder)) -> [[Duration; 2]; 2] {
    let mut taken = [Vec::new(), Vec::new()];
    for _ in 0..2 * FRAMES {
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let start = Instant::now();
        encode(&mut encoder);
        taken[0].push(start.elapsed());
        let start = Instant::now();
        gpu.queue().submit([encoder.finish()]);
        gpu.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
        taken[1].push(start.elapsed());
    }
    taken.map(|times| middle_and_least(times[FRAMES..].to_vec()))
}

fn middle_and_least(mut times: Vec<Duration>) -> [Duration; 2] {
    times.sort_unstable();
    [times[times.len() / 2], times[0]]
}
