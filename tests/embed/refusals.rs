//! Refused requests and their messages. Errors that wgpu reports during a refused call must not reach the application's
//! error handler, which [`App`] checks when dropped.

use gpu_smooth::{
    Goal, Gpu, GpuError, Guard, Mesh, MeshError, Method, Options, SmoothError, Stopping,
    gpu::{DeviceMesh, ObjectiveValues, Sweeps, VertexBuffer},
    options::{Paper, Relaxed},
    wgpu,
};
use wgpu::BufferUsages as Usage;

use crate::app::{App, Vertices, bad_plate};
use support::{lattice, orientations, transformed};

/// Checks the message for a refused vertex buffer. The mesh is a lattice of 36 vertices.
#[track_caller]
fn assert_place_refused(bytes: u64, usage: Usage, offset: u64, stride: u64, text: &str) {
    let app = App::new();
    let device_mesh = app.mesh(&lattice(5, 5));
    let buffer = app.buffer(bytes, usage);
    let place = VertexBuffer::new(buffer.slice(offset..), stride);
    let error = device_mesh.bind_vertices(&place).err().unwrap();
    assert!(matches!(error, GpuError::Buffer(_)), "{error:?}");
    let whole = format!("the application's buffer cannot be used: {text}");
    assert_eq!(error.to_string(), whole);
}

#[test]
fn a_buffer_without_storage_is_refused() {
    let text = "it was made for BufferUsages(COPY_DST | VERTEX), and needs STORAGE as well";
    assert_place_refused(1000, Usage::VERTEX | Usage::COPY_DST, 0, 8, text);
}

#[test]
fn a_buffer_too_small_is_refused() {
    // Required: 35 strides, plus x and y of the last vertex.
    assert_place_refused(
        12 * 35 + 4,
        Usage::STORAGE,
        0,
        12,
        "it has 424 bytes from byte 0 on, and 428 are needed",
    );
    let text = "it has 424 bytes from byte 8 on, and 428 are needed";
    assert_place_refused(432, Usage::STORAGE, 8, 12, text);
}

#[test]
fn a_buffer_just_large_enough_is_not() {
    let app = App::new();
    let device_mesh = app.mesh(&lattice(5, 5));
    let buffer = app.buffer(8 + 12 * 35 + 8, Usage::STORAGE);
    let place = VertexBuffer::new(buffer.slice(8..), 12);
    app.submit(|encoder| device_mesh.bind_vertices(&place).unwrap().encode_export(encoder));
}

#[test]
fn a_misaligned_offset_is_refused() {
    for offset in [1, 2, 6, 255] {
        let text = format!("the offset is {offset} bytes, not a multiple of 4");
        assert_place_refused(10_000, Usage::STORAGE, offset, 12, &text);
    }
}

#[test]
fn a_stride_that_fits_no_vertex_is_refused() {
    for stride in [0, 4, 6, 10, 13] {
        let text = format!("the stride is {stride} bytes, not a multiple of 4 of at least 8");
        assert_place_refused(10_000, Usage::STORAGE, 0, stride, &text);
    }
    for stride in [1 << 34, u64::MAX - 3] {
        let text = format!("the stride is {stride} bytes, which is more than 16 GiB");
        assert_place_refused(10_000, Usage::STORAGE, 0, stride, &text);
    }
}

/// At these coordinates, elements are smaller than the resolution of f32, so rounding would invert triangles.
#[test]
fn coordinates_that_single_precision_tangles_are_refused_with_an_origin() {
    let app = App::new();
    let lattice = lattice(5, 5);
    let buffer = app.buffer(1000, Usage::STORAGE);
    let place = VertexBuffer::new(buffer.slice(..), 12);
    let refused = |mesh: &Mesh, place: VertexBuffer<'_>, part: &str| {
        let error = app.mesh(mesh).bind_vertices(&place).err().unwrap();
        assert!(matches!(error, GpuError::Buffer(_)), "{error:?}");
        assert!(error.to_string().contains(part), "{error}");
    };
    let far = transformed(&lattice, 0.08, [500_000.0, 4_600_000.0]);
    refused(&far, place, "in single precision: set an origin in the mesh, such as 50000");
    app.mesh(&far).bind_vertices(&place.origin([500_000.0, 4_600_000.0])).unwrap();
    for (size, scale) in [(1e39, 1e-39), (1e-50, 1e50)] {
        let mesh = transformed(&lattice, size, [0.0, 0.0]);
        refused(&mesh, place, "coordinates leave the range of single precision: set a scale");
        app.mesh(&mesh).bind_vertices(&place.scale(scale)).unwrap();
    }
    refused(&lattice, place.origin([f64::NAN, 0.0]), "the origin is [NaN, 0.0], not a point");
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused(&lattice, place.scale(scale), "not a number above 0");
    }
}

/// Checks the message for a refused buffer for objectives.
#[track_caller]
fn assert_objective_refused(bytes: u64, usage: Usage, offset: u64, text: &str) {
    let app = App::new();
    let device_mesh = app.mesh(&lattice(5, 5));
    let sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    let buffer = app.buffer(bytes, usage);
    let error = sweeps.bind_objective(buffer.slice(offset..)).err().unwrap();
    assert!(matches!(error, GpuError::Buffer(_)), "{error:?}");
    assert!(error.to_string().ends_with(text), "{error}");
}

#[test]
fn a_buffer_for_objectives_is_checked_like_a_vertex_buffer() {
    let (storage, needed) = (Usage::STORAGE, size_of::<ObjectiveValues>() as u64);
    assert_objective_refused(needed, Usage::COPY_DST, 0, "and needs STORAGE as well");
    for (bytes, offset) in [(24, 0), (needed + 8, 40)] {
        let rest = bytes - offset;
        let text = format!("it has {rest} bytes from byte {offset} on, and {needed} are needed");
        assert_objective_refused(bytes, storage, offset, &text);
    }
    assert_objective_refused(needed + 4, storage, 2, "the offset is 2 bytes, not a multiple of 4");
}

#[test]
fn a_destroyed_buffer_is_refused() {
    let app = App::new();
    let mesh = lattice(5, 5);
    let device_mesh = app.mesh(&mesh);
    let vertices = Vertices::usual(&app, &mesh);
    vertices.buffer.destroy();
    let error = device_mesh.bind_vertices(&vertices.place()).err().unwrap();
    assert!(matches!(error, GpuError::Buffer(_)), "{error:?}");
    assert!(error.to_string().contains("destroyed"), "{error}");
}

#[test]
fn buffers_and_meshes_of_another_device_are_refused() {
    let (app, other) = (App::new(), App::new());
    let mesh = bad_plate(300);
    let device_mesh = app.mesh(&mesh);
    let sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    let vertices = Vertices::usual(&other, &mesh);
    let error = device_mesh.bind_vertices(&vertices.place()).err().unwrap();
    assert!(matches!(error, GpuError::Buffer(_)), "{error:?}");
    let error = sweeps.bind_objective(vertices.buffer.slice(..)).err().unwrap();
    assert!(matches!(error, GpuError::Buffer(_)), "{error:?}");
}

/// wgpu reports errors of a foreign queue to the handler of that queue's device. Error scopes of the other device do
/// not catch them.
#[test]
fn a_queue_of_another_device_is_refused() {
    let (app, other) = (App::new(), App::new());
    let refused = |app: &App, other: &App| {
        // Creating a device clears a buffer. Until the device has finished, a foreign queue cannot be detected.
        app.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
        let error = Gpu::new(app.device().clone(), other.gpu.queue().clone()).err().unwrap();
        assert!(matches!(error, GpuError::Queue), "{error:?}");
    };
    refused(&app, &other);
    // One device has executed commands, the other none.
    let mesh = bad_plate(300);
    app.points(&app.mesh(&mesh));
    refused(&app, &other);
    refused(&other, &app);
    app.another_gpu();
    other.another_gpu();
}

/// A former defect: polls reported the device as busy after the first handle, although nothing was submitted, and a
/// busy device accepts every queue.
#[test]
fn a_foreign_queue_is_refused_directly_after_a_handle_was_made() {
    let (app, other) = (App::new(), App::new());
    for attempt in 0..12 {
        app.another_gpu();
        let foreign = other.gpu.queue().clone();
        let error = Gpu::new(app.device().clone(), foreign).err();
        assert!(matches!(error, Some(GpuError::Queue)), "attempt {attempt}: {error:?}");
    }
}

#[test]
fn errors_of_an_encoder_reach_the_application_when_it_finishes_it() {
    let (app, other) = (App::new(), App::new());
    let mesh = bad_plate(300);
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    let vertices = Vertices::usual(&app, &mesh).bind(&device_mesh);
    let mut encoder = other.encoder();
    vertices.encode_import(&mut encoder);
    sweeps.encode_sweeps(&mut encoder, 2);
    assert!(other.take_uncaptured().is_empty());
    let _ = encoder.finish();
    assert_eq!(other.take_uncaptured().len(), 1);
}

fn mesh_error(mesh: &Mesh) -> MeshError {
    match DeviceMesh::new(&App::new().gpu, mesh) {
        Err(SmoothError::Mesh(error)) => error,
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("accepted"),
    }
}

#[test]
fn an_empty_mesh_is_refused() {
    assert_eq!(
        mesh_error(&Mesh::default()).to_string(),
        "the mesh has no triangles and no quadrilaterals"
    );
    let points = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let error = mesh_error(&Mesh { points, ..Mesh::default() });
    assert_eq!(error.to_string(), "the mesh has no triangles and no quadrilaterals");
}

#[test]
fn a_mesh_with_an_inverted_triangle_is_refused() {
    let mut mesh = lattice(5, 5);
    // Moves an inner vertex across its star.
    mesh.points[14][0] += 1.5;
    let error = mesh_error(&mesh);
    let MeshError::Infeasible { triangles, .. } = &error else { panic!("{error}") };
    let inverted: Vec<_> = (0..).zip(orientations(&mesh)).filter(|(_, sign)| *sign != 1).collect();
    assert!(inverted.len() > 1 && inverted.len() < 10);
    assert!(triangles.iter().map(|bad| bad.triangle).eq(inverted.iter().map(|(t, _)| *t)));
    assert!(triangles.iter().zip(inverted).all(|(bad, (_, sign))| bad.flat == (sign == 0)));
    let list: Vec<_> =
        triangles.iter().map(|bad| format!("{} ({})", bad.triangle, bad.problem())).collect();
    let text = format!("{} triangles are inverted or flat: {}", list.len(), list.join(", "));
    assert_eq!(error.to_string(), text);
}

#[test]
fn a_mesh_with_nothing_to_move_is_refused() {
    let points = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let error = mesh_error(&Mesh { points, triangles: vec![[0, 1, 2]], ..Mesh::default() });
    assert_eq!(error.to_string(), "none of the 3 vertices is free to move");
}

#[test]
fn options_out_of_range_are_refused() {
    let app = App::new();
    let device_mesh = app.mesh(&lattice(5, 5));
    let ok = Options::default;
    let omega = |omega| Method::Relaxed(Relaxed { omega: Some(omega), ..Relaxed::default() });
    let no_steps = Paper { newton_steps: 0, ..Paper::default() };
    for (options, text) in [
        (ok().method(omega(2.0)), "omega is 2: it must be above 0 and below 2"),
        (ok().method(omega(f64::NAN)), "omega is NaN: it must be above 0 and below 2"),
        (
            ok().method(Method::Paper(no_steps)),
            "newton steps is 0: it must be a number from 1 to 1000",
        ),
        (
            ok().stopping(Stopping::Tolerance(-1.0)),
            "tolerance is -1: it must be a finite number, 0 or above",
        ),
        (
            ok().max_move(Some(0.5)),
            "encoding sweeps does not go with max_move: only a whole run can do this; drop it, or do a whole run",
        ),
        (
            ok().stopping(Stopping::Goal(Goal { fraction: 0.9, desired: Some(1.0) })),
            "encoding sweeps does not go with Stopping::Goal: only a whole run can do this; drop it, or do a whole run",
        ),
        (
            ok().guard(Guard::Worst),
            "encoding sweeps does not go with Guard::Worst: only a whole run can do this; drop it, or do a whole run",
        ),
    ] {
        let error = Sweeps::new(&device_mesh, &options).block().err().unwrap();
        assert!(matches!(error, SmoothError::Option { .. }), "{error:?}");
        assert_eq!(error.to_string(), text);
    }
}

#[test]
fn errors_of_the_application_itself_still_reach_its_handler() {
    let app = App::new();
    // Error scopes of the library must have ended with its calls.
    let _ = app.mesh(&lattice(5, 5));
    let too_large = app.device().limits().max_buffer_size + 4;
    let _ = app.buffer(too_large, Usage::STORAGE);
    assert_eq!(app.take_uncaptured().len(), 1);
}
