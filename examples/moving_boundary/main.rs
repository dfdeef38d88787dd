//! A plate whose hole turns in each step of a simulation. Sweeps in each step keep the mesh good:
//!
//! ```text
//! cargo run --release --example moving_boundary -- [VERTICES] [SWEEPS]
//! ```
//!
//! A second mesh, moved equally but without sweeps, serves as comparison.
#![allow(clippy::print_stdout)]

use std::f64::consts::TAU;
use std::time::{Duration, Instant};

use gpu_smooth::{
    Gpu, Mesh, Options, Quality, Topology,
    gpu::{DeviceMesh, Sweeps, VertexBuffer},
    topology::signed_area,
    wgpu,
};
use wgpu::BufferUsages as Usage;
use wgpu::util::DeviceExt;

pub(crate) type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

const CENTER: [f64; 2] = [1.2, 1.0];
const RADIUS: f64 = 0.5;

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let vertices = args.next().map_or(Ok(4000), |arg| arg.parse())?;
    let sweeps = args.next().map_or(Ok(4), |arg| arg.parse())?;
    let steps = simulate(vertices, sweeps, 100, 0.75)?;

    println!("            with {sweeps} sweeps a step             with none");
    println!("step  angle  worst IMR  inverted     ms  worst IMR  inverted");
    for (k, step) in (1..).zip(&steps).filter(|(k, _)| k % 10 == 0) {
        let SweepParams { angle, took, kept: Quality { worst_imr, inverted, .. }, left } = step;
        let ms = took.as_secs_f64() * 1e3;
        print!("{k:>4} {angle:>5.1}°  {worst_imr:>9.2}  {inverted:>8}  {ms:>5.2}");
        println!("  {:>9.2}  {:>8}", left.worst_imr, left.inverted);
    }

    let mean = steps.iter().map(|step| step.took).sum::<Duration>() / steps.len() as u32;
    let worst = steps.iter().map(|step| step.kept.worst_imr).fold(0.0, f64::max);
    print!(
        "{vertices} vertices, {:.2} ms a step, worst element {worst:.2}",
        mean.as_secs_f64() * 1e3
    );
    match steps.iter().position(|step| step.left.inverted > 0) {
        Some(k) => println!("; without sweeps the first triangle inverts in step {}", k + 1),
        None => println!("; without sweeps none inverts"),
    }
    Ok(())
}

/// Result of a step.
pub(crate) struct SweepParams {
    /// Angle of the hole after the step, in degrees.
    pub(crate) angle: f64,
    /// Time from the step's first call until the device finished.
    pub(crate) took: Duration,
    /// Quality of the mesh smoothed in each step.
    pub(crate) kept: Quality,
    /// Quality of the mesh moved without sweeps.
    pub(crate) left: Quality,
}

/// Simulates `steps` steps, in each of which the hole turns by `degrees` degrees.
pub(crate) fn simulate(
    vertices: usize,
    sweeps: u32,
    steps: u32,
    degrees: f64,
) -> Result<Vec<SweepParams>> {
    let mesh = plate(vertices)?;
    let topology = Topology::new(&mesh)?;
    let hole = hole(&topology, &mesh.points);

    // `Gpu::open` creates a device for programs that have none; examples/embed uses a device of its own.
    let gpu = Gpu::open(None).block()?;
    let (device, queue) = (gpu.device(), gpu.queue());
    let positions: Vec<[f32; 2]> = mesh.points.iter().map(|p| p.map(|x| x as f32)).collect();
    let buffer = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("vertices"),
        contents: bytemuck::cast_slice(&positions),
        usage: Usage::VERTEX | Usage::STORAGE | Usage::COPY_DST,
    });
    let stride = size_of::<[f32; 2]>() as u64;
    let device_mesh = DeviceMesh::new(&gpu, &mesh)?;
    let bound = device_mesh.bind_vertices(&VertexBuffer::new(buffer.slice(..), stride))?;
    let mut smoother = Sweeps::new(&device_mesh, &Options::default()).block()?;

    let mut left_alone = mesh.points.clone();
    let mut log = Vec::new();
    for k in 1..=steps {
        let angle = f64::from(k) * degrees;
        let turned = hole.iter().map(|&v| (v, turned(mesh.points[v as usize], angle / 360.0)));

        let start = Instant::now();
        for (v, [x, y]) in turned.clone() {
            let xy = [x as f32, y as f32];
            queue.write_buffer(&buffer, stride * u64::from(v), bytemuck::cast_slice(&xy));
        }
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        // Other vertices still have the floats of the last export, so the import keeps their full precision.
        bound.encode_import(&mut encoder);
        // No `restart`: the hole turns by less than an edge length, and over-relaxed sweeps spread the motion farther
        // into the mesh than plain sweeps.
        smoother.encode_sweeps(&mut encoder, sweeps);
        bound.encode_export(&mut encoder);
        queue.submit([encoder.finish()]);
        // A simulation would use the vertex buffer here. This example waits for the device, to measure the time.
        device.poll(wgpu::PollType::wait_indefinitely())?;
        let took = start.elapsed();

        turned.for_each(|(v, point)| left_alone[v as usize] = point);
        log.push(SweepParams {
            angle,
            took,
            kept: Quality::of(&device_mesh.read_points().block()?, &topology)?,
            left: Quality::of(&left_alone, &topology)?,
        });
    }
    Ok(log)
}

/// Makes a plate of 3 by 2 with a round hole.
fn plate(vertices: usize) -> Result<Mesh> {
    let [x, y] = CENTER;
    let outline = format!("loop\n0 0\n3 0\n3 2\n0 2\ncircle {x} {y} {RADIUS} 48\n");
    Ok(support::triangulate(&support::Outline::parse(&outline)?, vertices)?)
}

/// Returns the vertices of the hole, the clockwise loop of the boundary.
fn hole(topology: &Topology<'_>, points: &[[f64; 2]]) -> Vec<u32> {
    let mut loops = topology.boundary_loops().into_iter();
    loops.find(|vertices| signed_area(points, vertices) < 0.0).unwrap_or_default()
}

fn turned([x, y]: [f64; 2], turns: f64) -> [f64; 2] {
    let (sin, cos) = (turns * TAU).sin_cos();
    let (dx, dy) = (x - CENTER[0], y - CENTER[1]);
    [CENTER[0] + cos * dx - sin * dy, CENTER[1] + sin * dx + cos * dy]
}
