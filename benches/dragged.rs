//! Frames after a drag until a mesh in an application is near its optimum again, with and without corrections from
//! coarser levels. Also measures the duration of a correction.
//!
//! `cargo bench --bench dragged -- [VERTICES...]`, 57,000 by default. The mesh is a plate at its optimum, whose larger
//! hole is dragged in 60 frames, as far as triangles allow. A frame has three sweeps and, with corrections, three
//! corrections.

#![allow(clippy::print_stdout)]

use std::time::Instant;

use gpu_smooth::{
    Backend, Gpu, Mesh, Method, Metric, Options, Smoother, Stopping, Topology,
    gpu::{DeviceMesh, ObjectiveValues, Readback, Sweeps, VertexBuffer},
    topology::signed_area,
    wgpu::{self, BufferUsages as Usage},
};

/// Sweeps per frame.
const SWEEPS: u32 = 3;
/// Distances of the drags, in units of a plate of 3 by 2.
const FAR: [f64; 2] = [0.2, 0.4];
/// Frames per drag.
const FRAMES: usize = 60;
/// Largest number of frames after a drag.
const MOST: usize = 200;

fn main() {
    let sizes: Vec<usize> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    let sizes = if sizes.is_empty() { vec![57_000] } else { sizes };
    let outline = support::Outline::parse(include_str!("../meshes/plate.outline")).unwrap();
    let gpu = Gpu::open(None).block().unwrap();
    println!("{}", gpu.adapter().name);
    for vertices in sizes {
        let mesh = support::triangulate(&outline, vertices).unwrap();
        let (mesh, _) = optimum(&mesh);
        for far in FAR {
            measure(&gpu, &mesh, Method::RELAXED, far);
            measure(&gpu, &mesh, Method::Multilevel, far);
        }
    }
}

/// Returns the mesh at its optimum, and f of the optimum.
fn optimum(mesh: &Mesh) -> (Mesh, f64) {
    let options = Options::default().stopping(Stopping::Tolerance(1e-9));
    let run = Smoother::new(mesh).unwrap();
    let run = run.run(&options).on(&Backend::Cpu).block().unwrap();
    let f = run.history.last().and_then(|f| f.of(Metric::Imr)).unwrap();
    (Mesh { points: run.points, ..mesh.clone() }, f)
}

/// Drags the hole by `far`, and counts the frames until f is near its limit.
fn measure(gpu: &Gpu, mesh: &Mesh, method: Method, far: f64) {
    let options = &Options::default().method(method);
    let buffer = |size: usize, usage| {
        gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: size as u64,
            usage,
            mapped_at_creation: false,
        })
    };
    let device_mesh = DeviceMesh::new(gpu, mesh).unwrap();
    let start = Instant::now();
    let mut sweeps = Sweeps::new(&device_mesh, options).block().unwrap();
    let made = start.elapsed();
    let numbers = buffer(256, Usage::STORAGE | Usage::COPY_SRC);
    let objective = sweeps.bind_objective(numbers.slice(..)).unwrap();
    let mut values = Readback::<ObjectiveValues>::new(gpu, numbers.slice(..), 1).unwrap();

    let mut loops = Topology::new(mesh).unwrap().boundary_loops();
    // The signed area of a hole is negative, so sorting puts the largest hole first.
    let area = |vertices: &Vec<u32>| signed_area(&mesh.points, vertices);
    loops.sort_by(|a, b| area(a).total_cmp(&area(b)));
    let hole = loops.swap_remove(0);
    let targets = buffer(8 * hole.len(), Usage::STORAGE | Usage::COPY_DST);
    let drag = device_mesh.bind_move(
        &hole,
        &VertexBuffer::new(targets.slice(..), 8),
        8.0,
        numbers.slice(128..),
    );
    let drag = drag.unwrap();

    let mut times = Vec::new();
    let mut frame = |sweeps: &mut Sweeps, dragged: Option<usize>| {
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        if let Some(frame) = dragged {
            let part = far * (frame + 1) as f64 / FRAMES as f64;
            let to: Vec<[f32; 2]> = hole
                .iter()
                .map(|&v| mesh.points[v as usize])
                .map(|[x, y]| [(x + part) as f32, y as f32])
                .collect();
            gpu.queue().write_buffer(&targets, 0, bytemuck::cast_slice(&to));
            drag.encode_move(&mut encoder);
        }
        let start = Instant::now();
        sweeps.encode_sweeps(&mut encoder, SWEEPS);
        let encoding = start.elapsed();
        let commands = encoder.finish();
        let start = Instant::now();
        gpu.queue().submit([commands]);
        gpu.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
        times.push((encoding, start.elapsed()));
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        objective.encode_objective(&mut encoder);
        values.encode_readback(&mut encoder);
        gpu.queue().submit([encoder.finish()]);
        gpu.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
        values.latest().unwrap().unwrap()[0]
    };
    let mut last = ObjectiveValues::default();
    for step in 0..FRAMES {
        last = frame(&mut sweeps, Some(step));
    }
    let dragged = Mesh { points: device_mesh.read_points().block().unwrap(), ..mesh.clone() };
    let end = optimum(&dragged).1;
    let gone = dragged.points[hole[0] as usize][0] - mesh.points[hole[0] as usize][0];
    let mut reached = [None; 3];
    let start = f64::from(last.of(Metric::Imr)) / end - 1.0;
    for number in 1..=MOST {
        let values = frame(&mut sweeps, None);
        let excess = f64::from(values.of(Metric::Imr)) / end - 1.0;
        for (reached, share) in reached.iter_mut().zip([1e-3, 1e-5, 1e-6]) {
            if excess <= share {
                reached.get_or_insert(number);
            }
        }
        if reached[2].is_some() {
            break;
        }
    }
    times.sort_unstable();
    let encoding = times[times.len() / 2].0;
    let mut whole: Vec<_> = times.iter().map(|time| time.1).collect();
    whole.sort_unstable();
    let reached = reached.map(|at| at.map_or(format!("over {MOST}"), |number| number.to_string()));
    println!(
        "{:>7} dragged by {gone:.3} of {far}, {method:?}: f {start:.1e} above its limit, within 1e-3, 1e-5 and 1e-6 after frames {}; \
         made in {:.1} ms, encode {:.1} µs, frame {:.2} ms, the fastest {:.2}",
        mesh.points.len(),
        reached.join(", "),
        1e3 * made.as_secs_f64(),
        1e6 * encoding.as_secs_f64(),
        1e3 * whole[whole.len() / 2].as_secs_f64(),
        1e3 * whole[0].as_secs_f64(),
    );
}
