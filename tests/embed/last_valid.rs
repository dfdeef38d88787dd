//! Restoration of frames in which the application has inverted triangles.

use gpu_smooth::{Options, gpu::Sweeps, topology};

use crate::app::{App, Vertices, bad_plate, interior};

#[test]
fn a_mesh_that_the_application_has_tangled_goes_back_to_where_it_was_valid() {
    let app = App::new();
    let mesh = bad_plate(600);
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    let vertices = Vertices::usual(&app, &mesh);
    let bound = vertices.bind(&device_mesh);
    let last_valid = device_mesh.keep_last_valid().unwrap();
    let mut frame = || {
        app.submit(|encoder| {
            bound.encode_import(encoder);
            sweeps.encode_sweeps(encoder, 3);
            last_valid.encode_restore_last_valid(encoder);
            bound.encode_export(encoder);
        });
        app.points(&device_mesh)
    };
    // Valid frames stay unchanged.
    let first = frame();
    assert_ne!(first, mesh.points);
    let good = frame();
    assert_ne!(good, first);

    // Moves a boundary vertex and an inner vertex far out of their stars, and a third vertex so little that no triangle
    // inverts.
    let boundary = (0..mesh.points.len() as u32).find(|v| !interior(&mesh).contains(v)).unwrap();
    let [u, v] = [interior(&mesh)[50], interior(&mesh)[200]];
    vertices.put(&app, boundary, [5.0, 5.0]);
    vertices.put(&app, u, [-0.4, 2.5]);
    let [x, y] = good[v as usize];
    vertices.put(&app, v, [x + 1e-4, y]);
    assert_eq!(frame(), good);
    // The vertex buffer is restored too, so that the next frame continues from valid positions.
    let words = app.read(&vertices.buffer);
    let [x, y] = good[u as usize].map(|x| (x as f32).to_bits());
    assert_eq!(words[vertices.word(u)..vertices.word(u) + 2], [x, y]);
    let next = frame();
    assert_ne!(next, good);
    assert!(topology::infeasible(&next, &mesh.triangles).unwrap().is_empty());
}

#[test]
fn a_mesh_that_was_never_valid_in_a_frame_goes_back_to_where_it_was_uploaded() {
    let app = App::new();
    let mesh = bad_plate(300);
    let device_mesh = app.mesh(&mesh);
    let start = app.points(&device_mesh);
    let options = Options::default().max_sweeps(1);
    let mut sweeps = Sweeps::until_converged(&device_mesh, &options).block().unwrap();
    let vertices = Vertices::usual(&app, &mesh);
    let bound = vertices.bind(&device_mesh);
    let last_valid = device_mesh.keep_last_valid().unwrap();
    drop(device_mesh);
    vertices.put(&app, interior(&mesh)[20], [9.0, 9.0]);
    app.submit(|encoder| {
        bound.encode_import(encoder);
        sweeps.encode_sweeps(encoder, 1);
        last_valid.encode_restore_last_valid(encoder);
    });
    // A restoration also counts as a change of the mesh.
    assert_eq!(app.objective(&sweeps).stop(), None);
    app.submit(|encoder| bound.encode_export(encoder));
    let words = app.read(&vertices.buffer);
    for (v, p) in (0..).zip(&start) {
        let at = vertices.word(v);
        assert_eq!(words[at..at + 2], p.map(|x| (x as f32).to_bits()), "vertex {v}");
    }
}
