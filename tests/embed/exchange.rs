//! Import and export of positions, from and to a vertex buffer of the application.

use gpu_smooth::{Mesh, Options, gpu::Sweeps};

use crate::app::{App, Vertices, bad_plate, filler, interior, plate};
use support::{boundary, f_imr, perturb_random, transformed};

/// Makes a mesh with unused vertices at the front, in the middle and at the end.
fn with_unused_vertices() -> Mesh {
    let mut mesh = bad_plate(500);
    let places = [0, 300, 502];
    for place in places {
        mesh.points.insert(place, [-7.0, 11.0]);
        for v in mesh.triangles.as_flattened_mut() {
            *v += u32::from(*v as usize >= place);
        }
    }
    mesh
}

/// Tested layouts of vertex buffers, as `[offset, stride]` in bytes.
const LAYOUTS: &[[u64; 2]] =
    &[[0, 8], [4, 8], [0, 12], [268, 12], [12, 20], [1020, 20], [260, 256], [0, 1036]];

#[test]
fn an_export_writes_x_and_y_of_used_vertices_and_nothing_else() {
    let mesh = with_unused_vertices();
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    for &[offset, stride] in LAYOUTS {
        let vertices = Vertices::new(&app, &mesh, offset, stride);
        let before = app.read(&vertices.buffer);
        app.submit(|encoder| {
            vertices.bind(&device_mesh).encode_import(encoder);
            sweeps.encode_sweeps(encoder, 2);
            vertices.bind(&device_mesh).encode_export(encoder);
        });
        let (points, after) = (app.points(&device_mesh), app.read(&vertices.buffer));
        let mut expected: Vec<u32> = (0..after.len()).map(filler).collect();
        for &v in mesh.triangles.as_flattened() {
            let at = vertices.word(v);
            for (word, x) in (at..).zip(points[v as usize]) {
                let exported = f32::from_bits(after[word]);
                let off = (f64::from(exported) - x).abs();
                assert!(off <= x.abs() * 2f64.powi(-24), "{offset} {stride}: {exported} for {x}");
                expected[word] = after[word];
            }
        }
        assert!(expected == after, "{offset} {stride}: something else was written");
        let kept = boundary(&mesh);
        let used = |v: u32| before[vertices.word(v)] != filler(vertices.word(v));
        let moved = |v: u32| before[vertices.word(v)] != after[vertices.word(v)];
        for v in (0..mesh.points.len() as u32).filter(|&v| kept[v as usize] || !used(v)) {
            assert!(!moved(v), "vertex {v} of the boundary or of no triangle");
        }
        assert!(interior(&mesh).into_iter().filter(|&v| moved(v)).count() > 200);
    }
}

#[test]
fn an_import_reads_every_layout_alike() {
    let mesh = with_unused_vertices();
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    for (i, &[offset, stride]) in LAYOUTS.iter().enumerate() {
        // Each time, all vertices have new positions, including boundary vertices.
        let there = transformed(&mesh, 1.0 + i as f64 / 8.0, [i as f64, -0.5]);
        let vertices = Vertices::new(&app, &there, offset, stride);
        app.submit(|encoder| {
            vertices.bind(&device_mesh).encode_import(encoder);
        });
        let points = app.points(&device_mesh);
        for &v in mesh.triangles.as_flattened() {
            let given = there.points[v as usize].map(|x| f64::from(x as f32));
            for (x, found) in given.into_iter().zip(points[v as usize]) {
                assert!((x - found).abs() <= 1e-12 * 20.0, "{offset} {stride}: {found} for {x}");
            }
        }
        // An unused vertex keeps its position in the mesh.
        assert_eq!(points[300], mesh.points[300]);
    }
}

#[test]
fn an_origin_and_a_scale_are_those_of_the_buffer() {
    let mesh = transformed(&bad_plate(500), 0.08, [500_000.0, 4_600_000.0]);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let vertices = Vertices::usual(&app, &mesh);
    let (origin, scale) = ([500_000.1, 4_600_000.05], 25.0);
    let place = vertices.place().origin(origin).scale(scale);
    let bound = device_mesh.bind_vertices(&place).unwrap();
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    app.submit(|encoder| {
        sweeps.encode_sweeps(encoder, 2);
        bound.encode_export(encoder);
    });
    let (points, words) = (app.points(&device_mesh), app.read(&vertices.buffer));
    for &v in mesh.triangles.as_flattened() {
        for axis in 0..2 {
            let found = f64::from(f32::from_bits(words[vertices.word(v) + axis]));
            let expected = (points[v as usize][axis] - origin[axis]) * scale;
            assert!((found - expected).abs() < 1e-5, "{found} for {expected}");
        }
    }
    // Unchanged vertices keep all digits. A move by 0.01 in the mesh is exported as a move by 0.01.
    app.submit(|encoder| bound.encode_import(encoder));
    assert_eq!(app.points(&device_mesh), points);
    let v = interior(&mesh)[0];
    let [x, y] = [0, 1].map(|axis| (points[v as usize][axis] - origin[axis] + 0.01) * scale);
    vertices.put(&app, v, [x, y]);
    app.submit(|encoder| bound.encode_import(encoder));
    for (after, before) in app.points(&device_mesh)[v as usize].iter().zip(points[v as usize]) {
        assert!((after - before - 0.01).abs() < 1e-6, "{after} after {before}");
    }
}

/// The product with a scale that is no power of two lost the digits of vertices near the origin of the buffer.
#[test]
fn vertices_near_the_origin_of_a_scaled_buffer_keep_their_digits() {
    let mesh = bad_plate(500);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let vertices = Vertices::usual(&app, &mesh);
    let scale = f64::from(0.001_f32);
    for origin in interior(&mesh).into_iter().step_by(7) {
        let origin = mesh.points[origin as usize];
        let place = vertices.place().origin(origin).scale(scale);
        let bound = device_mesh.bind_vertices(&place).unwrap();
        app.submit(|encoder| bound.encode_export(encoder));
        let words = app.read(&vertices.buffer);
        for &v in mesh.triangles.as_flattened() {
            for axis in 0..2 {
                let found = f64::from(f32::from_bits(words[vertices.word(v) + axis]));
                let expected = (mesh.points[v as usize][axis] - origin[axis]) * scale;
                let error = (found - expected).abs();
                assert!(error <= 1.2e-7 * expected.abs() + 1e-13, "{found} for {expected}");
            }
        }
    }
}

#[test]
fn vertices_that_the_application_leaves_alone_keep_their_full_precision() {
    // Far from the origin, the floats of the buffer resolve a 30th of an edge. The mesh is perturbed less than others,
    // because a buffer is refused if rounding inverts triangles in it.
    let mesh = perturb_random(&plate(700), 0.3, 7);
    let mesh = transformed(&mesh, 4.0, [300_000.0, -200_000.0]);
    let app = App::new();
    let [alone, exchanged] = [false, true].map(|exchange| {
        let device_mesh = app.mesh(&mesh);
        let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
        let vertices = Vertices::usual(&app, &mesh);
        for _ in 0..20 {
            app.submit(|encoder| {
                if exchange {
                    vertices.bind(&device_mesh).encode_import(encoder);
                }
                sweeps.encode_sweeps(encoder, 3);
                if exchange {
                    vertices.bind(&device_mesh).encode_export(encoder);
                }
            });
        }
        app.points(&device_mesh)
    });
    assert_eq!(alone, exchanged);

    // Rounded to floats, the mesh is far worse, so the test would detect lost digits.
    let rounded = alone.iter().map(|p| p.map(|x| f64::from(x as f32))).collect();
    let f = |points: Vec<[f64; 2]>| f_imr(&Mesh { points, ..mesh.clone() });
    assert!(f(rounded) > f(alone) + 1e-3);
}

#[test]
fn a_vertex_the_application_moves_is_followed() {
    let mesh = bad_plate(700);
    let on_boundary = boundary(&mesh);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let vertices = Vertices::usual(&app, &mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    let frame = |sweeps: &mut Sweeps, count| {
        app.submit(|encoder| {
            vertices.bind(&device_mesh).encode_import(encoder);
            sweeps.encode_sweeps(encoder, count);
            vertices.bind(&device_mesh).encode_export(encoder);
        });
        Mesh { points: app.points(&device_mesh), ..mesh.clone() }
    };
    let smooth = frame(&mut sweeps, 40);

    // Moves the plate's first corner inward, and an inner vertex within its star.
    let corner = mesh.points.iter().position(|&p| p == [0.0, 0.0]).unwrap() as u32;
    let inner = interior(&mesh)[100];
    assert!(on_boundary[corner as usize] && !on_boundary[inner as usize]);
    let neighbor = *mesh.triangles.iter().find(|t| t.contains(&inner)).unwrap();
    let neighbor = neighbor.into_iter().find(|&v| v != inner).unwrap();
    let [here, there] = [inner, neighbor].map(|v| smooth.points[v as usize]);
    let nearby = [0, 1].map(|x| f64::from((0.6 * here[x] + 0.4 * there[x]) as f32));
    vertices.put(&app, corner, [0.03, 0.02]);
    vertices.put(&app, inner, nearby);

    let taken = frame(&mut sweeps, 0);
    for (v, (was, is)) in smooth.points.iter().zip(&taken.points).enumerate() {
        let expected = match v as u32 {
            v if v == corner => [0.03, 0.02].map(|x| f64::from(x as f32)),
            v if v == inner => nearby,
            _ => *was,
        };
        let off = (0..2).map(|x| (expected[x] - is[x]).abs()).fold(0.0, f64::max);
        assert!(off < 1e-12, "vertex {v} is at {is:?} instead of {expected:?}");
    }
    assert!(f_imr(&taken) > f_imr(&smooth) + 1e-4);

    // The corner stays at its new position, the inner vertex returns, and the mesh around both becomes smooth.
    let mended = frame(&mut sweeps, 40);
    assert_eq!(mended.points[corner as usize], taken.points[corner as usize]);
    assert_ne!(mended.points[inner as usize], taken.points[inner as usize]);
    assert!(f_imr(&mended) < f_imr(&taken) - 1e-4);
    let neighbors = mesh.triangles.iter().filter(|t| t.contains(&corner)).flatten();
    let follows = |&v: &u32| mended.points[v as usize] != smooth.points[v as usize];
    assert!(neighbors.copied().filter(|&v| !on_boundary[v as usize]).any(|v| follows(&v)));
}

#[test]
fn two_vertex_buffers_can_show_one_mesh() {
    let mesh = bad_plate(500);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    let [first, second] = [[0, 8], [16, 24]]
        .map(|[offset, stride]| (Vertices::new(&app, &mesh, offset, stride), stride));
    app.submit(|encoder| {
        sweeps.encode_sweeps(encoder, 4);
        for (vertices, _) in [&first, &second] {
            vertices.bind(&device_mesh).encode_export(encoder);
        }
    });
    let (a, b) = (app.read(&first.0.buffer), app.read(&second.0.buffer));
    for v in interior(&mesh) {
        let (at, other) = (first.0.word(v), second.0.word(v));
        assert_eq!(a[at..at + 2], b[other..other + 2]);
    }
}

#[test]
fn a_position_that_is_not_finite_is_not_taken() {
    let mesh = bad_plate(500);
    let app = App::new();
    let (v, others) = (interior(&mesh)[100], interior(&mesh));
    for scheme in ["imr", "rms", "area"] {
        let device_mesh = app.mesh(&mesh);
        let options = Options::default().scheme(scheme.parse().unwrap());
        let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
        for wrong in [[f64::NAN; 2], [1.0, f64::INFINITY], [f64::NEG_INFINITY, 1.0]] {
            let vertices = Vertices::usual(&app, &mesh);
            vertices.put(&app, v, wrong);
            let before = app.points(&device_mesh);
            app.submit(|encoder| {
                vertices.bind(&device_mesh).encode_import(encoder);
            });
            assert_eq!(app.points(&device_mesh)[v as usize], before[v as usize]);
            app.submit(|encoder| {
                sweeps.encode_sweeps(encoder, 10);
                vertices.bind(&device_mesh).encode_export(encoder);
            });
            let words = app.read(&vertices.buffer);
            for &v in &others {
                let at = vertices.word(v);
                assert!(words[at..at + 2].iter().all(|&x| f32::from_bits(x).is_finite()));
            }
        }
    }
}
