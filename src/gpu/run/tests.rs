//! Visits of sliding vertices on a device, compared with those of the CPU.

use std::sync::Arc;

use glam::DVec2;

use super::dispatches::Dispatches;
use super::slides::Slides;
use crate::gpu::encode::sealed::Target;
use crate::gpu::kernels::uniforms::join;
use crate::gpu::mesh::{Curves, MeshBuffers};
use crate::gpu::{Gpu, Waiting};
use crate::layout::{Problem, prepare};
use crate::mesh::Mesh;
use crate::metric::Metric;
use crate::options::Options;
use crate::parallel::pace::now;
use crate::periodic::Periodic;
use crate::run::Plan;
use crate::slide::{OnCurves, Slide, Sliding};

/// Returns a lattice mapped from the unit square by `to`, with uneven spacing. The first row of vertices ends at x = 1.
fn mapped(to: impl Fn([f64; 2]) -> [f64; 2]) -> Mesh {
    let (columns, rows) = (12_u32, 6_u32);
    let uneven = |k: u32, of: u32| {
        let x = f64::from(k) / f64::from(of);
        x + 0.06 * (std::f64::consts::TAU * x).sin()
    };
    let at = |v: u32| to([uneven(v % (columns + 1), columns), uneven(v / (columns + 1), rows)]);
    let cell = |k: u32| {
        let a = k / columns * (columns + 1) + k % columns;
        let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
        [[a, b, d], [a, d, c]]
    };
    Mesh {
        points: (0..(columns + 1) * (rows + 1)).map(at).collect(),
        triangles: (0..columns * rows).flat_map(cell).collect(),
        ..Mesh::default()
    }
}

/// Returns meshes with straight and bent lines, a closed curve, and periodic pairs.
fn cases() -> Vec<(&'static str, Mesh, Slide)> {
    let wavy = |[u, v]: [f64; 2]| [3.0 * u, v + 0.1 * (9.0 * u).sin()];
    // A disc of two rings around its center.
    let ring = |k: u32, radius: f64| {
        let turn = f64::from(k) + 0.2 * f64::from(k % 3);
        let (sin, cos) = (turn * std::f64::consts::TAU / 18.0).sin_cos();
        [radius * cos + 5.0, radius * sin + 0.1]
    };
    let mut points: Vec<[f64; 2]> = (0..18).map(|k| ring(k, 1.0)).collect();
    points.extend((0..18).map(|k| ring(k, 0.6)));
    points.push([5.0, 0.1]);
    let of = |k: u32| {
        let next = (k + 1) % 18;
        [[k, next, 18 + k], [next, 18 + next, 18 + k], [18 + k, 18 + next, 36]]
    };
    let disc = Mesh { points, triangles: (0..18).flat_map(of).collect(), ..Mesh::default() };
    let pairs = (0..7).map(|row| [13 * row, 13 * row + 12]).collect();
    let periodic = vec![Periodic { pairs, motion: None }];
    vec![
        ("channel", mapped(|[u, v]| [2.0 * u, v]), Slide::default()),
        ("wavy", mapped(wavy), Slide::default()),
        ("narrow", mapped(wavy), Slide { hausdorff: Some(2e-4), ..Slide::default() }),
        ("disc", disc, Slide::default()),
        ("pairs", mapped(|[u, v]| [2.0 * u, v]), Slide { periodic, ..Slide::default() }),
    ]
}

/// The visits of a mesh on both engines.
struct Both {
    problem: Problem,
    host: OnCurves,
    positions: Vec<DVec2>,
    device: OnCurves,
    on_device: Vec<DVec2>,
}

/// Visits the sliding vertices once on each engine, in the order of the device's colors.
fn visited(gpu: &Gpu, mesh: &Mesh, slide: &Slide, metric: Metric) -> Both {
    let (topology, problem) = prepare(mesh).unwrap();
    let sliding = Sliding::new(&mesh.points, &topology, slide);
    let sliding = sliding.numbered(&problem, mesh.points.len());
    let start = OnCurves::new(Arc::new(sliding), None, 0.0);
    let plan = Plan::new(&Options { scheme: metric.into(), ..Options::default() });
    let step = plan.base_step(1.0);
    let (mut host, mut positions) = (start.clone(), problem.positions().to_vec());
    let table = start.table(&problem);
    for color in &table.colors {
        let all = &table.vertices[color.start as usize..color.end as usize];
        let of_color = |v| all.iter().any(|vertex| vertex.vertex == v);
        host.visit_by(&step, &problem, &mut positions, of_color);
    }
    let mut buffers = now(MeshBuffers::new(gpu, &problem, problem.positions())).unwrap();
    buffers.curves = Some(Curves::new(gpu, &problem, &start, false).unwrap());
    let dispatches =
        now(Dispatches::new(gpu, &problem, &buffers, plan, vec![step], false)).unwrap();
    let curves = buffers.curves.as_ref().unwrap();
    let run = [&dispatches.params, &dispatches.control];
    let slides = now(Slides::new(gpu, &buffers, curves, run, vec![step], false)).unwrap();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut passes = encoder.passes("visits");
    slides.encode_visits(&mut passes, &step);
    drop(passes);
    gpu.queue.submit([encoder.finish()]);
    let waiting = Waiting::Block;
    let device = now(curves.read(gpu, &problem, &curves.places, waiting)).unwrap();
    let count = problem.positions().len();
    let on_device = now(buffers.read_positions(gpu, count, waiting)).unwrap();
    let on_device = on_device.into_iter().map(join).collect();
    Both { problem, host, positions, device, on_device }
}

/// The visits of one color are independent of each other, so both engines take equal steps up to rounding.
#[test]
fn both_engines_visit_vertices_on_curves_alike() {
    let gpu = Gpu::open(None).block().unwrap();
    for (name, mesh, slide) in cases() {
        let metrics = if name == "pairs" { Metric::ALL } else { &[Metric::Imr, Metric::Rms] };
        // The distance of a line from a given vertex grows with the square of a step, and single precision needs a reserve.
        let share = if name == "narrow" { 1e-2 } else { 2e-3 };
        for &metric in metrics {
            let Both { problem, host, positions, device, on_device } =
                visited(&gpu, &mesh, &slide, metric);
            let label = format!("{name}, {metric}");
            // The positions on the device are those of the parameters that are read back.
            let mut of_params = problem.positions().to_vec();
            device.write_positions(&problem, &mut of_params);
            let off = |a: &[DVec2], b: &[DVec2]| {
                a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
            };
            let on_curve = off(&of_params, &on_device);
            assert!(on_curve < 1e-6, "{label}: {on_curve}");
            let moved = off(&positions, problem.positions());
            let apart = off(&positions, &on_device);
            assert!(moved > 0.0 && apart < share * moved + 1e-6, "{label}: {moved} {apart}");
            let far = host.places(&problem).into_iter().zip(device.places(&problem));
            let far = far.map(|(a, b)| (a.param - b.param).abs()).fold(0.0, f64::max);
            assert!(far < share * moved + 1e-6, "{label}: {far}");
        }
    }
}

/// A visit reads the vertices around a vertex and around its partner, and the parameters of the neighbors on the curve.
#[test]
fn vertices_of_a_color_are_independent() {
    for (name, mesh, slide) in cases() {
        let (topology, problem) = prepare(&mesh).unwrap();
        let sliding = Sliding::new(&mesh.points, &topology, &slide);
        let sliding = sliding.numbered(&problem, mesh.points.len());
        let table = OnCurves::new(Arc::new(sliding), None, 0.0).table(&problem);
        assert!(table.vertices.len() > 8 && table.colors.len() < 6, "{name}");
        for color in &table.colors {
            let all = &table.vertices[color.start as usize..color.end as usize];
            let own = |i: usize| [Some(all[i].vertex), all[i].partner].into_iter().flatten();
            let owners: Vec<(u32, usize)> =
                (0..all.len()).flat_map(|i| own(i).map(move |v| (v, i))).collect();
            let owner = |v: u32| owners.iter().find(|(u, _)| *u == v).map(|(_, i)| *i);
            for triangle in problem.triangles() {
                let found: Vec<usize> = triangle.iter().filter_map(|&v| owner(v)).collect();
                assert!(found.len() < 2, "{name}: {triangle:?}");
            }
            let is_neighbor = |place: &u32| all.iter().any(|vertex| vertex.place == *place);
            assert!(!all.iter().any(|vertex| vertex.neighbors.iter().any(is_neighbor)), "{name}");
        }
    }
}
