//! Moves of vertices on the device, clamped where triangles require it.

use gpu_smooth::{
    GpuError, Mesh, MeshError, Options, SmoothError, Topology,
    gpu::{BoundMove, DeviceMesh, Sweeps, VertexBuffer},
    topology, wgpu,
};
use wgpu::BufferUsages as Usage;

use crate::app::{App, Vertices, bad_plate, filler, interior, plate};
use support::transformed;

/// Buffers of a drag: targets, and numbers with the completed fraction between fillers.
struct Drag {
    targets: wgpu::Buffer,
    numbers: wgpu::Buffer,
    bound: BoundMove,
}

const SHARE: usize = 3;

impl Drag {
    fn new(app: &App, mesh: &DeviceMesh, vertices: &[u32], worst_imr: f64) -> Self {
        let bytes = 8 * vertices.len().max(1) as u64;
        let targets = app.buffer(bytes, Usage::STORAGE | Usage::COPY_DST);
        let numbers = app.buffer(32, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST);
        let fillers: Vec<u32> = (0..8).map(filler).collect();
        app.gpu.queue().write_buffer(&numbers, 0, bytemuck::cast_slice(&fillers));
        let place = VertexBuffer::new(targets.slice(..), 8);
        let share = numbers.slice(4 * SHARE as u64..);
        let bound = mesh.bind_move(vertices, &place, worst_imr, share).unwrap();
        Self { targets, numbers, bound }
    }

    /// Moves toward targets in one frame. Returns the completed fraction of the move.
    fn go(&self, app: &App, to: &[[f64; 2]]) -> f32 {
        let to: Vec<[f32; 2]> = to.iter().map(|p| p.map(|x| x as f32)).collect();
        app.gpu.queue().write_buffer(&self.targets, 0, bytemuck::cast_slice(&to));
        app.submit(|encoder| self.bound.encode_move(encoder));
        let words = app.read(&self.numbers);
        let untouched = (0..8).filter(|&i| i != SHARE).all(|i| words[i] == filler(i));
        assert!(untouched, "{words:x?}");
        f32::from_bits(words[SHARE])
    }
}

fn rounded(p: [f64; 2]) -> [f64; 2] {
    p.map(|x| f64::from(x as f32))
}

/// Returns the vertices of a plate's hole.
fn hole(mesh: &Mesh) -> Vec<u32> {
    let topology = Topology::new(mesh).unwrap();
    topology.boundary_loops().into_iter().min_by_key(Vec::len).unwrap()
}

/// Executes equal moves on the host and on the device. The completed fractions must agree up to a relative
/// difference of `loss`.
#[track_caller]
fn assert_as_on_the_host(
    app: &App,
    mesh: &Mesh,
    moves: &[(u32, [f64; 2])],
    worst: f64,
    loss: f64,
) -> f64 {
    let topology = Topology::new(mesh).unwrap();
    let device_mesh = app.mesh(mesh);
    let before = app.points(&device_mesh);
    let vertices: Vec<u32> = moves.iter().map(|&(v, _)| v).collect();
    let to: Vec<_> = moves.iter().map(|&(_, to)| to).collect();
    let share = f64::from(Drag::new(app, &device_mesh, &vertices, worst).go(app, &to));
    let moved = app.points(&device_mesh);

    let mut expected = before.clone();
    let of_host = topology.move_clamped(&mut expected, moves, worst).unwrap();
    assert!((share - of_host).abs() <= loss * (of_host + 0.05), "{share} for {of_host}");
    assert_eq!(share == 1.0, of_host == 1.0);
    let reach = |v: &u32| {
        let (from, to) = (before[*v as usize], moves.iter().rev().find(|(w, _)| w == v).unwrap().1);
        (to[0] - from[0]).hypot(to[1] - from[1])
    };
    for v in 0..mesh.points.len() as u32 {
        let (found, wanted) = (moved[v as usize], expected[v as usize]);
        if vertices.contains(&v) {
            let apart = (found[0] - wanted[0]).hypot(found[1] - wanted[1]);
            assert!(apart <= loss * reach(&v) * (of_host + 0.05) + 1e-6, "vertex {v}: {apart:e}");
        } else {
            assert_eq!(found, before[v as usize], "vertex {v}");
        }
    }
    let bad = topology::infeasible(&moved, &mesh.triangles).unwrap();
    assert!(bad.is_empty(), "{bad:?}");
    for corners in &mesh.triangles {
        let (was, is) = (imr(&before, corners), imr(&moved, corners));
        assert!(is <= worst.min(1e5).max(was) * (1.0 + 1e-6 * was.max(1.0)), "{was} to {is}");
    }
    share
}

fn imr(points: &[[f64; 2]], corners: &[u32; 3]) -> f64 {
    let [p, q, r] = corners.map(|v| points[v as usize]);
    let squared = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2);
    let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    (squared(p, q) + squared(q, r) + squared(r, p)) / (2.0 * 3f64.sqrt() * area.abs())
}

#[test]
fn a_clamped_move_goes_as_far_as_on_the_host() {
    let app = App::new();
    let mesh = plate(600);
    let hole = hole(&mesh);
    assert!(hole.len() < 100);
    let free = interior(&mesh);
    let mut shares = Vec::new();
    for (i, worst) in [2.0, 8.0, 1e3, f64::INFINITY].into_iter().enumerate() {
        for [dx, dy] in [[0.01, 0.0], [0.2, 0.1], [-3.0, 0.4], [50.0, -70.0]] {
            let there = |v: &u32| {
                let [x, y] = mesh.points[*v as usize];
                (*v, rounded([x + dx, y + dy]))
            };
            let all: Vec<_> = hole.iter().map(there).collect();
            shares.push(assert_as_on_the_host(&app, &mesh, &all, worst, 2e-5));
            let one = [there(&free[17 * i + 3])];
            shares.push(assert_as_on_the_host(&app, &mesh, &one, worst, 2e-5));
        }
    }
    // Some moves are completed, and some are stopped.
    assert!(shares.contains(&1.0) && shares.iter().any(|&s| s < 1e-2));
    assert!(shares.iter().all(|&s| s > 0.0), "{shares:?}");
}

#[test]
fn triangles_worse_than_the_bound_do_not_get_worse() {
    let app = App::new();
    let mesh = bad_plate(300);
    let mut shares = Vec::new();
    for v in interior(&mesh).into_iter().step_by(9) {
        for sign in [-0.2, 0.2] {
            let [x, y] = mesh.points[v as usize];
            let to = rounded([x + sign, y - 0.7 * sign]);
            shares.push(assert_as_on_the_host(&app, &mesh, &[(v, to)], 1.2, 0.01));
        }
    }
    // Vertices can move toward better positions, but not toward worse ones.
    assert!(shares.iter().any(|&s| s > 0.05) && shares.iter().any(|&s| s < 1e-5), "{shares:?}");
}

#[test]
fn a_vertex_that_reaches_its_target_is_there_exactly() {
    let app = App::new();
    let origin = [500_000.0, 4_600_000.0];
    let mesh = transformed(&plate(300), 0.5, origin);
    let device_mesh = app.mesh(&mesh);
    let v = interior(&mesh)[40];
    let targets = app.buffer(24, Usage::STORAGE | Usage::COPY_DST);
    let share = app.buffer(4, Usage::STORAGE | Usage::COPY_SRC);
    let place = VertexBuffer::new(targets.slice(4..), 16).origin(origin).scale(2.0);
    let bound = device_mesh.bind_move(&[v, v], &place, 8.0, share.slice(..)).err().unwrap();
    assert!(bound.to_string().contains("it has 20 bytes from byte 4 on, and 24"), "{bound}");
    let bound = device_mesh.bind_move(&[v], &place, 8.0, share.slice(..)).unwrap();
    let [x, y] = mesh.points[v as usize];
    let to = [(x - origin[0] + 1e-3) * 2.0, (y - origin[1]) * 2.0].map(|x| x as f32);
    app.gpu.queue().write_buffer(&targets, 4, bytemuck::cast_slice(&to));
    app.submit(|encoder| bound.encode_move(encoder));
    assert_eq!(app.read(&share), [1.0f32.to_bits()]);
    let [x, y] = app.points(&device_mesh)[v as usize];
    let there = [0, 1].map(|i| f64::from(to[i]) / 2.0 + origin[i]);
    assert!((x - there[0]).abs() < 1e-9 && (y - there[1]).abs() < 1e-9, "{x} {y} {there:?}");
}

#[test]
fn targets_that_are_no_points_and_repeated_vertices_are_taken_as_on_the_host() {
    let app = App::new();
    let mut mesh = plate(300);
    mesh.points.push([9.0, 9.0]);
    let unused = mesh.points.len() as u32 - 1;
    let device_mesh = app.mesh(&mesh);
    let (v, w) = (interior(&mesh)[20], interior(&mesh)[80]);
    let at = |v: u32| mesh.points[v as usize];
    let drag = Drag::new(&app, &device_mesh, &[v, w, v, unused], 8.0);
    let before = app.points(&device_mesh);
    let there = rounded([at(v)[0] + 1e-3, at(v)[1]]);
    let share = drag.go(&app, &[[90.0, 0.0], [f64::NAN, 0.0], there, [0.5, 0.5]]);
    let after = app.points(&device_mesh);
    assert_eq!(share, 1.0);
    assert!((after[v as usize][0] - there[0]).abs() < 1e-12, "the last target of v counts");
    assert_eq!(after[w as usize], before[w as usize]);
    assert_eq!(after[unused as usize], [9.0, 9.0]);
    // A move without vertices.
    assert_eq!(Drag::new(&app, &device_mesh, &[], 8.0).go(&app, &[]), 1.0);
    assert_eq!(app.points(&device_mesh), after);
}

#[test]
fn a_dragged_hole_goes_out_and_home_with_sweeps_between_and_inverts_nothing() {
    let app = App::new();
    let mesh = plate(600);
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    let vertices = Vertices::usual(&app, &mesh).bind(&device_mesh);
    let hole = hole(&mesh);
    let drag = Drag::new(&app, &device_mesh, &hole, 8.0);
    let mut gone = Vec::new();
    for reach in [[1.5, 0.0], [0.0, 0.0]] {
        for _ in 0..40 {
            let to: Vec<_> = hole
                .iter()
                .map(|&v| [0, 1].map(|i| mesh.points[v as usize][i] + reach[i]))
                .collect();
            drag.go(&app, &to);
            app.submit(|encoder| {
                sweeps.encode_sweeps(encoder, 3);
                vertices.encode_export(encoder);
            });
            let value = app.objective(&sweeps);
            assert!(value.inverted == 0 && value.worst_imr < 8.001, "{value:?}");
        }
        gone.push(app.points(&device_mesh)[hole[0] as usize][0] - mesh.points[hole[0] as usize][0]);
        let bad = topology::infeasible(&app.points(&device_mesh), &mesh.triangles).unwrap();
        assert!(bad.is_empty(), "{bad:?}");
    }
    // The edge of the plate stops the hole before the move is complete.
    assert!(gone[0] > 0.5 && gone[0] < 1.5 && gone[1].abs() < 1e-6, "{gone:?}");
}

#[test]
fn a_move_that_cannot_be_bound_is_refused() {
    let app = App::new();
    let mesh = plate(300);
    let device_mesh = app.mesh(&mesh);
    let buffer = app.buffer(64, Usage::STORAGE);
    let other = app.buffer(8, Usage::COPY_DST);
    let place = VertexBuffer::new(buffer.slice(..), 8);
    let refused = |vertices: &[u32], worst, share: wgpu::BufferSlice<'_>| {
        device_mesh.bind_move(vertices, &place, worst, share).err().unwrap()
    };
    let error = refused(&[0], f64::NAN, buffer.slice(..));
    assert!(matches!(error, SmoothError::Mesh(MeshError::BoundNotANumber)), "{error}");
    let error = refused(&[5, 100_000], 8.0, buffer.slice(..));
    let SmoothError::Mesh(MeshError::IndexOutOfRange { vertex: 100_000, .. }) = error else {
        panic!("{error}");
    };
    for (error, part) in [
        (refused(&[0], 8.0, buffer.slice(32..)), "targets and share are in one buffer"),
        (refused(&[0], 8.0, other.slice(..)), "needs STORAGE as well"),
        (
            refused(&[0; 9], 8.0, other.slice(..)),
            "it has 64 bytes from byte 0 on, and 72 are needed",
        ),
    ] {
        assert!(matches!(error, SmoothError::Gpu(GpuError::Buffer(_))), "{error:?}");
        assert!(error.to_string().contains(part), "{error}");
    }
}
