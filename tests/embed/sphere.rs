//! Meshes on the sphere, whose vertices move in the Mercator projection on the device too.

use gpu_smooth::{
    GpuError, Mesh, Method, Options, Smoother, Targets,
    gpu::{Sweeps, VertexBuffer},
    wgpu,
};
use support::SplitMix64;
use wgpu::BufferUsages as Usage;

use crate::app::{App, Vertices, gpu_error};

const COLUMNS: u32 = 30;
const ROWS: u32 = 28;

/// Returns a lattice over longitudes from -30 to 30 and latitudes from 20 to 75 degrees. Vertices inside are perturbed by
/// up to 0.3 of the distances.
fn lattice() -> Mesh {
    let mut random = SplitMix64::new(3);
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for (row, column) in (0..=ROWS).flat_map(|row| (0..=COLUMNS).map(move |column| (row, column))) {
        let is_inside = row % ROWS != 0 && column % COLUMNS != 0;
        let mut off = || if is_inside { random.range(-0.3, 0.3) } else { 0.0 };
        let [x, y] = [f64::from(column) + off(), f64::from(row) + off()];
        let part = [x / f64::from(COLUMNS), y / f64::from(ROWS)];
        points.push([60.0 * part[0] - 30.0, 55.0 * part[1] + 20.0]);
        if row < ROWS && column < COLUMNS {
            let at = |c: u32, r: u32| (row + r) * (COLUMNS + 1) + column + c;
            triangles.push([at(0, 0), at(1, 0), at(1, 1)]);
            triangles.push([at(0, 0), at(1, 1), at(0, 1)]);
        }
    }
    Mesh { points, triangles, ..Mesh::default() }
}

fn on_sphere(mesh: &Mesh) -> Smoother<'_> {
    let mut smoother = Smoother::new(mesh).unwrap();
    assert!(smoother.project_from_sphere().unwrap());
    smoother
}

/// Returns the Mercator projection of a point by a formula that the library does not use.
fn image([x, y]: [f64; 2]) -> [f64; 2] {
    let half = 0.5 * y.to_radians() + 0.25 * std::f64::consts::PI;
    [x, half.tan().ln().to_degrees()]
}

fn images(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    points.iter().map(|&point| image(point)).collect()
}

fn assert_near(found: &[[f64; 2]], expected: &[[f64; 2]], within: f64) {
    for (v, (found, expected)) in found.iter().zip(expected).enumerate() {
        let off = (0..2).map(|i| (found[i] - expected[i]).abs()).fold(0.0, f64::max);
        assert!(off < within, "vertex {v}: {found:?} instead of {expected:?}");
    }
}

/// A former defect: degrees in the buffer of an application were taken for coordinates of the projection.
#[test]
fn a_buffer_in_degrees_is_refused_for_a_mesh_that_moves_in_the_projection() {
    let (app, mesh) = (App::new(), lattice());
    let device_mesh = on_sphere(&mesh).to_device(&app.gpu).unwrap();
    let vertices = Vertices::usual(&app, &mesh);
    let numbers = app.buffer(256, Usage::STORAGE | Usage::COPY_SRC);
    let bind = |place: &VertexBuffer<'_>| {
        let share = device_mesh.bind_move(&[317], place, 8.0, numbers.slice(..));
        let drawn = device_mesh.bind_drawn_objective(place, &Options::default(), numbers.slice(..));
        [
            device_mesh.bind_vertices(place).err(),
            share.err().map(gpu_error),
            drawn.err().map(gpu_error),
        ]
    };
    for error in bind(&vertices.place()) {
        let Some(GpuError::Buffer(text)) = error else { panic!("{error:?}") };
        assert!(text.contains("VertexBuffer::in_mercator_projection"), "{text}");
    }
    for error in bind(&vertices.place().in_mercator_projection()) {
        assert!(error.is_none(), "{error:?}");
    }
    // A mesh in the plane takes no coordinates of the projection.
    let place = vertices.place().in_mercator_projection();
    let error = app.mesh(&mesh).bind_vertices(&place).err().unwrap();
    assert!(
        error.to_string().contains("leave out VertexBuffer::in_mercator_projection"),
        "{error}"
    );
}

#[test]
fn coordinates_of_the_projection_are_exported_and_imported() {
    let (app, mesh) = (App::new(), lattice());
    let smoother = on_sphere(&mesh);
    let device_mesh = smoother.to_device(&app.gpu).unwrap();
    assert_near(&app.points(&device_mesh), &mesh.points, 1e-9);
    let projected = Mesh { points: images(&mesh.points), ..mesh.clone() };
    let vertices = Vertices::usual(&app, &projected);
    let place = vertices.place().in_mercator_projection();
    let bound = device_mesh.bind_vertices(&place).unwrap();
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    app.submit(|encoder| {
        bound.encode_import(encoder);
        sweeps.encode_sweeps(encoder, 3);
        bound.encode_export(encoder);
    });
    let points = app.points(&device_mesh);
    assert!(points.iter().zip(&mesh.points).filter(|(a, b)| a != b).count() > 500);
    let words: Vec<u32> = app.read(&vertices.buffer);
    let drawn = |v: u32| [0, 1].map(|i| f64::from(f32::from_bits(words[vertices.word(v) + i])));
    let drawn: Vec<_> = (0..mesh.points.len() as u32).map(drawn).collect();
    assert_near(&drawn, &images(&points), 2e-5);
    // The application moves a vertex.
    let to = [points[317][0] + 0.1, points[317][1] - 0.1];
    vertices.put(&app, 317, image(to));
    app.submit(|encoder| bound.encode_import(encoder));
    let mut expected = points;
    expected[317] = to;
    assert_near(&app.points(&device_mesh), &expected, 2e-5);
}

/// A former defect: a mesh with fixed vertices was laid out without the projection, but with targets for the projection.
#[test]
fn fixed_vertices_leave_sweeps_in_the_projection() {
    let (app, mesh) = (App::new(), lattice());
    let held = vec![317, 400, 401];
    let fixed = Mesh { fixed: held.clone(), ..mesh.clone() };
    let sizes: Vec<f64> = mesh.points.iter().map(|[_, y]| 1.0 + 0.02 * y).collect();
    let targets = Targets::sizes(&sizes).unwrap();
    let options = Options::default().method(Method::RELAXED);
    for with_targets in [false, true] {
        let [pinned, held] = [&mesh, &fixed].map(|given| {
            let mut smoother = on_sphere(given);
            if with_targets {
                smoother.set_targets(&targets).unwrap();
            }
            let device_mesh = smoother.to_device(&app.gpu).unwrap();
            device_mesh.pin(&held).unwrap();
            let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
            let metric = options.scheme.base();
            let on_device = f64::from(app.objective(&sweeps).of(metric));
            let expected = smoother.f(metric, &given.points).unwrap();
            assert!((on_device / expected - 1.0).abs() < 1e-5, "{on_device} {expected}");
            app.submit(|encoder| sweeps.encode_sweeps(encoder, 6));
            app.points(&device_mesh)
        });
        assert_eq!(pinned, held);
        assert!(held.iter().zip(&mesh.points).filter(|(a, b)| a != b).count() > 500);
        assert_near(&held[317..318], &mesh.points[317..318], 1e-12);
    }
}
