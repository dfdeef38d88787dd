//! Objectives in a buffer of the application, compared with those of the points read back.

use gpu_smooth::{
    Mesh, Metric, Options, Quality, Topology,
    gpu::{ObjectiveValues, Sweeps},
};
use wgpu::BufferUsages as Usage;

use gpu_smooth::wgpu;

use crate::app::{App, Vertices, bad_plate, filler, interior};
use support::{orientations, transformed};

const WORDS: usize = size_of::<ObjectiveValues>() / 4;

fn quality(mesh: &Mesh, points: &[[f64; 2]]) -> Quality {
    Quality::of(points, &Topology::new(mesh).unwrap()).unwrap()
}

fn all_tracked() -> Options {
    Options::default().scheme("edge+imr".parse().unwrap()).track_all(true)
}

fn readable(app: &App, floats: usize) -> wgpu::Buffer {
    app.buffer(4 * floats as u64, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST)
}

#[test]
fn objectives_are_those_of_the_points_read_back() {
    for mesh in [bad_plate(800), transformed(&bad_plate(300), 1e-4, [2.0, 1.0])] {
        let app = App::new();
        let device_mesh = app.mesh(&mesh);
        let mut sweeps = Sweeps::new(&device_mesh, &all_tracked()).block().unwrap();
        for stage in 0..6 {
            app.submit(|encoder| sweeps.encode_sweeps(encoder, stage));
            let found = app.objective(&sweeps);
            let expected = quality(&mesh, &app.points(&device_mesh));
            for &metric in Metric::ALL {
                let (found, f) = (found.of(metric), expected.f(metric));
                let off = (f64::from(found) / f - 1.0).abs();
                assert!(off < 1e-5, "{metric} at stage {stage}: {found} for {f}");
            }
            let off = f64::from(found.worst_imr) / expected.worst_imr - 1.0;
            assert!(off.abs() < 1e-4, "{} for {}", found.worst_imr, expected.worst_imr);
            assert_eq!(found.inverted, 0);
        }
    }
}

#[test]
fn the_worst_triangle_is_known_whatever_the_metric() {
    let mesh = bad_plate(400);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let expected = quality(&mesh, &mesh.points).worst_imr;
    for &metric in Metric::ALL {
        let options = Options::default().scheme(metric.into());
        let found = app.objective(&Sweeps::new(&device_mesh, &options).block().unwrap()).worst_imr;
        let off = f64::from(found) / expected - 1.0;
        assert!(off.abs() < 1e-4, "{metric}: {found} for {expected}");
    }
}

#[test]
fn several_evaluations_in_one_command_buffer_are_each_of_their_moment() {
    let mesh = bad_plate(500);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &all_tracked()).block().unwrap();
    // More sweeps than the history on the device can hold.
    let count = 300;
    let published = readable(&app, WORDS * count);
    app.submit(|encoder| {
        for k in 0..count {
            let offset = (4 * WORDS * k) as u64;
            sweeps.bind_objective(published.slice(offset..)).unwrap().encode_objective(encoder);
            sweeps.encode_sweeps(encoder, u32::from(k < 40));
        }
    });
    let found = app.read(&published);
    let rows: &[ObjectiveValues] = bytemuck::cast_slice(&found);
    let of_imr = |row: usize| f64::from(rows[row].of(Metric::Imr));
    let first = quality(&mesh, &mesh.points).f(Metric::Imr);
    let last = quality(&mesh, &app.points(&device_mesh)).f(Metric::Imr);
    assert!((of_imr(0) / first - 1.0).abs() < 1e-5);
    assert!((of_imr(count - 1) / last - 1.0).abs() < 1e-5);
    assert!(rows[..20].windows(2).all(|pair| pair[0] != pair[1]));
    assert!(rows[40..].windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn metrics_not_tracked_are_zero_and_the_rest_of_the_buffer_untouched() {
    let mesh = bad_plate(300);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let options = Options::default().scheme(Metric::Rms.into());
    let sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
    for first in [0usize, 1, 63, 64, 70] {
        let published = readable(&app, 100);
        let words: Vec<u32> = (0..100).map(filler).collect();
        app.gpu.queue().write_buffer(&published, 0, bytemuck::cast_slice(&words));
        app.submit(|encoder| {
            sweeps
                .bind_objective(published.slice(4 * first as u64..))
                .unwrap()
                .encode_objective(encoder);
        });
        let found = app.read(&published);
        let written: &ObjectiveValues =
            bytemuck::from_bytes(bytemuck::cast_slice(&found[first..first + WORDS]));
        assert!(written.of(Metric::Rms) > 1.0);
        // Room for further metrics holds zeros too.
        assert_eq!(written.f.iter().filter(|f| **f == 0.0).count(), written.f.len() - 1);
        let outside = |&at: &usize| at < first || at >= first + WORDS;
        assert!((0..100).filter(outside).all(|at| found[at] == words[at]));
    }
}

#[test]
fn triangles_the_application_inverts_are_counted() {
    let mesh = bad_plate(800);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let sweeps = Sweeps::new(&device_mesh, &all_tracked()).block().unwrap();
    let vertices = Vertices::usual(&app, &mesh);
    let mut counts = Vec::new();
    for v in interior(&mesh).into_iter().step_by(60) {
        // A position far out of the star.
        vertices.put(&app, v, [-0.4, 2.5]);
        app.submit(|encoder| {
            vertices.bind(&device_mesh).encode_import(encoder);
        });
        let points = app.points(&device_mesh);
        let exact = orientations(&Mesh { points, ..mesh.clone() });
        let exact = exact.into_iter().filter(|&sign| sign != 1).count();
        let found = app.objective(&sweeps);
        assert_eq!((found.inverted as usize, found.worst_imr), (exact, f32::INFINITY));
        counts.push(exact);
    }
    assert!(counts.is_sorted() && counts[0] >= 1 && *counts.last().unwrap() > 20, "{counts:?}");
}

/// Returns the inverse mean ratio of a triangle, negative if inverted.
fn imr(points: &[[f64; 2]], corners: [u32; 3]) -> f64 {
    let [p, q, r] = corners.map(|v| points[v as usize]);
    let edge = |p: [f64; 2], q: [f64; 2]| [q[0] - p[0], q[1] - p[1]];
    let (a, b, c) = (edge(p, q), edge(p, r), edge(q, r));
    let squares: f64 = [a, b, c].as_flattened().iter().map(|x| x * x).sum();
    squares / (2.0 * 3f64.sqrt() * (a[0] * b[1] - a[1] * b[0]))
}

#[test]
fn the_worst_triangle_is_named() {
    let mesh = bad_plate(900);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    let mut named = std::collections::HashSet::new();
    for _ in 0..8 {
        let found = app.objective(&sweeps);
        let corners = device_mesh.vertices_of(found.worst_element).unwrap().try_into().unwrap();
        let ratio = imr(&app.points(&device_mesh), corners);
        assert!((f64::from(found.worst_imr) / ratio - 1.0).abs() < 1e-4, "{ratio} in {found:?}");
        named.insert(corners);
        app.submit(|encoder| sweeps.encode_sweeps(encoder, 1));
    }
    assert!(named.len() > 2);

    // Inverted triangles count as worse than all others.
    let vertices = Vertices::usual(&app, &mesh);
    vertices.put(&app, interior(&mesh)[70], [-0.4, 2.5]);
    app.submit(|encoder| vertices.bind(&device_mesh).encode_import(encoder));
    let found = app.objective(&sweeps);
    let corners = device_mesh.vertices_of(found.worst_element).unwrap().try_into().unwrap();
    assert!(found.inverted > 0 && imr(&app.points(&device_mesh), corners) < 0.0);
    assert_eq!(device_mesh.vertices_of(mesh.triangles.len() as u32), None);
}

#[test]
fn equilateral_triangles_are_named_too() {
    let height = 0.75f64.sqrt();
    let around = [[1.0, 0.0], [0.5, height], [-0.5, height], [-1.0, 0.0], [-0.5, -height]];
    let points = around.into_iter().chain([[0.5, -height], [0.0, 0.0]]).collect();
    let triangles = (0..6).map(|i| [i, (i + 1) % 6, 6]).collect();
    let app = App::new();
    let device_mesh = app.mesh(&Mesh { points, triangles, ..Mesh::default() });
    let found = app.objective(&Sweeps::new(&device_mesh, &Options::default()).block().unwrap());
    assert!((found.worst_imr - 1.0).abs() < 1e-6);
    assert!(device_mesh.vertices_of(found.worst_element).unwrap().contains(&6));
}

#[test]
fn the_objective_is_that_of_the_floats_as_drawn_if_asked_for() {
    // At these coordinates, single precision resolves a hundredth of an edge.
    let mesh = transformed(&bad_plate(600), 0.02, [400.0, -300.0]);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &all_tracked()).block().unwrap();
    for (origin, scale) in [([0.0; 2], 1.0), ([399.0, 0.0], 16.0)] {
        let vertices = Vertices::usual(&app, &mesh);
        let place = vertices.place().origin(origin).scale(scale);
        let bound = device_mesh.bind_vertices(&place).unwrap();
        let published = readable(&app, WORDS);
        let drawn = device_mesh.bind_drawn_objective(&place, &all_tracked(), published.slice(..));
        let drawn = drawn.unwrap();
        let evaluated = || -> ObjectiveValues {
            app.submit(|encoder| drawn.encode_objective(encoder));
            bytemuck::pod_read_unaligned(bytemuck::cast_slice(&app.read(&published)))
        };
        let mut points = Vec::new();
        for _ in 0..3 {
            app.submit(|encoder| {
                sweeps.encode_sweeps(encoder, 1);
                bound.encode_export(encoder);
            });
            let found = evaluated();
            let words = app.read(&vertices.buffer);
            let float = |v: u32, i| f64::from(f32::from_bits(words[vertices.word(v) + i]));
            let all = 0..mesh.points.len() as u32;
            points = all.map(|v| [0, 1].map(|i| float(v, i) / scale + origin[i])).collect();
            let exact = quality(&mesh, &points);
            for &metric in Metric::ALL {
                let (found, f) = (f64::from(found.of(metric)), exact.f(metric));
                // Metrics of size depend on the mean area at upload, other metrics on the shape alone.
                let bound = if metric.properties().scale_invariant { 1e-5 } else { 1e-2 };
                assert!((found / f - 1.0).abs() < bound, "{metric}: {found} for {f}");
            }
            assert!((f64::from(found.worst_imr) / exact.worst_imr - 1.0).abs() < 1e-3);
            // Positions on the device have more digits than the floats in the buffer.
            let own = app.objective(&sweeps);
            let off = |metric| (found.of(metric) / own.of(metric) - 1.0).abs();
            assert!(off(Metric::Edge) > 3e-5, "{found:?} {own:?}");
        }
        // A vertex is moved in the buffer only. The drawn mesh then has an inverted triangle, unlike the mesh on the
        // device.
        let v = interior(&mesh)[50];
        let [x, y] = [0, 1].map(|i| (points[v as usize][i] - origin[i]) * scale);
        vertices.put(&app, v, [x + 2.0 * scale, y]);
        assert!(evaluated().inverted > 0);
        assert_eq!(app.objective(&sweeps).inverted, 0);
        vertices.put(&app, v, [x, y]);
        assert_eq!(evaluated().inverted, 0);
        assert_eq!((evaluated().stop(), evaluated().sweeps), (None, 0));
    }
}
