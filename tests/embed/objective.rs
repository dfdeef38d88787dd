//! Objectives written into a buffer of the application, against those of the points read back.

use gpu_smooth::{Mesh, Metric, ObjectiveValues, Options, Quality, Sweeps, Topology};
use wgpu::BufferUsages as Usage;

use gpu_smooth::wgpu;

use crate::app::{App, Vertices, bad_plate, filler, interior};
use crate::support::{orientations, transformed};

const WORDS: usize = size_of::<ObjectiveValues>() / 4;

fn quality(mesh: &Mesh, points: &[[f64; 2]]) -> Quality {
    Quality::of(points, &Topology::new(mesh).unwrap()).unwrap()
}

fn all_tracked() -> Options {
    Options { scheme: "edge+imr".parse().unwrap(), track_all: true, ..Options::default() }
}

fn readable(app: &App, floats: usize) -> wgpu::Buffer {
    app.buffer(4 * floats as u64, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST)
}

fn floats(words: &[u32]) -> Vec<f32> {
    words.iter().map(|&word| f32::from_bits(word)).collect()
}

#[test]
fn objectives_are_those_of_the_points_read_back() {
    for mesh in [bad_plate(800), transformed(&bad_plate(300), 1e-4, [2.0, 1.0])] {
        let app = App::new();
        let device_mesh = app.mesh(&mesh);
        let mut sweeps = Sweeps::new(&device_mesh, &all_tracked()).unwrap();
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
        let options = Options { scheme: metric.into(), ..Options::default() };
        let found = app.objective(&Sweeps::new(&device_mesh, &options).unwrap()).worst_imr;
        let off = f64::from(found) / expected - 1.0;
        assert!(off.abs() < 1e-4, "{metric}: {found} for {expected}");
    }
}

#[test]
fn several_evaluations_in_one_command_buffer_are_each_of_their_moment() {
    let mesh = bad_plate(500);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &all_tracked()).unwrap();
    // More than the device remembers.
    let count = 300;
    let published = readable(&app, WORDS * count);
    app.submit(|encoder| {
        for k in 0..count {
            let offset = (4 * WORDS * k) as u64;
            sweeps.bind_objective(&published, offset).unwrap().encode_objective(encoder);
            sweeps.encode_sweeps(encoder, u32::from(k < 40));
        }
    });
    let found = floats(&app.read(&published));
    let rows: Vec<&[f32]> = found.chunks(WORDS).collect();
    let imr = Metric::Imr as usize;
    let first = quality(&mesh, &mesh.points).f(Metric::Imr);
    let last = quality(&mesh, &app.points(&device_mesh)).f(Metric::Imr);
    assert!((f64::from(rows[0][imr]) / first - 1.0).abs() < 1e-5);
    assert!((f64::from(rows[count - 1][imr]) / last - 1.0).abs() < 1e-5);
    assert!(rows[..20].windows(2).all(|pair| pair[0] != pair[1]));
    assert!(rows[40..].windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn what_is_not_tracked_is_zero_and_the_rest_of_the_buffer_untouched() {
    let mesh = bad_plate(300);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let options = Options { scheme: Metric::Rms.into(), ..Options::default() };
    let sweeps = Sweeps::new(&device_mesh, &options).unwrap();
    for first in [0usize, 1, 63, 64, 70] {
        let published = readable(&app, 90);
        let words: Vec<u32> = (0..90).map(filler).collect();
        app.gpu.queue().write_buffer(&published, 0, bytemuck::cast_slice(&words));
        app.submit(|encoder| {
            sweeps.bind_objective(&published, 4 * first as u64).unwrap().encode_objective(encoder);
        });
        let found = app.read(&published);
        let written = &floats(&found)[first..first + WORDS];
        for &metric in Metric::ALL.iter().filter(|&&metric| metric != Metric::Rms) {
            assert_eq!(written[metric as usize], 0.0, "{metric}");
        }
        assert!(written[Metric::Rms as usize] > 1.0);
        let outside = |&at: &usize| at < first || at >= first + WORDS;
        assert!((0..90).filter(outside).all(|at| found[at] == words[at]));
    }
}

#[test]
fn triangles_the_application_inverts_are_counted() {
    let mesh = bad_plate(800);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let sweeps = Sweeps::new(&device_mesh, &all_tracked()).unwrap();
    let vertices = Vertices::usual(&app, &mesh);
    let mut counts = Vec::new();
    for v in interior(&mesh).into_iter().step_by(60) {
        // Out of its star, by far.
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
