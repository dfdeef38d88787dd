//! Meshes of quadrilaterals on the device of an application.

use gpu_smooth::{
    Mesh, Metric, Options, Quality, Smoother, Topology,
    gpu::{DeviceMesh, Sweeps, UntanglingSweeps, VertexBuffer},
    topology, wgpu,
};
use support::quadrilaterals::{mixed, perturbed, squares};
use wgpu::BufferUsages as Usage;

use crate::app::App;

fn meshes() -> [Mesh; 2] {
    [squares(12), mixed(12)].map(|mesh| perturbed(&mesh, 0.25))
}

fn quality(mesh: &Mesh, points: &[[f64; 2]]) -> Quality {
    Quality::of(points, &Topology::new(mesh).unwrap()).unwrap()
}

#[test]
fn values_of_frames_are_those_of_the_host() {
    let app = App::new();
    for mesh in meshes() {
        let device_mesh = app.mesh(&mesh);
        let options = Options::default().track_all(true);
        let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
        for round in 0..4 {
            let (found, points) = (app.objective(&sweeps), app.points(&device_mesh));
            let expected = quality(&mesh, &points);
            for &metric in Metric::ALL {
                let (found, expected) = (f64::from(found.of(metric)), expected.f(metric));
                let off = (found - expected).abs();
                assert!(off < 2e-5 * expected.max(0.01), "{metric}, {round}: {found} {expected}");
            }
            assert_eq!(found.inverted, 0);
            assert!((f64::from(found.worst_imr) / expected.worst_imr - 1.0).abs() < 1e-5);
            let mut worst = device_mesh.vertices_of(found.worst_element).unwrap();
            worst.sort_unstable();
            let elements = mesh.triangles.iter().map(|t| t.to_vec());
            let mut elements: Vec<_> =
                elements.chain(mesh.quadrilaterals.iter().map(|q| q.to_vec())).collect();
            assert_eq!(device_mesh.vertices_of(elements.len() as u32), None);
            elements.iter_mut().for_each(|vertices| vertices.sort_unstable());
            assert!(elements.contains(&worst));
            app.submit(|encoder| sweeps.encode_sweeps(encoder, 3));
        }
    }
}

#[test]
fn frames_end_at_the_minimum_of_a_run() {
    let app = App::new();
    for mesh in meshes() {
        let device_mesh = app.mesh(&mesh);
        let mut sweeps =
            Sweeps::until_converged(&device_mesh, &Options::default()).block().unwrap();
        let ends = (0..60).any(|_| {
            app.submit(|encoder| sweeps.encode_sweeps(encoder, 5));
            app.objective(&sweeps).stop().is_some()
        });
        assert!(ends);
        let f = |points: &[[f64; 2]]| quality(&mesh, points).f(Metric::Imr);
        let outcome = Smoother::new(&mesh).unwrap().run(&Options::default()).block().unwrap();
        let (found, expected) = (f(&app.points(&device_mesh)), f(&outcome.points));
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
    }
}

#[test]
fn a_drag_goes_as_far_as_on_the_host() {
    let app = App::new();
    for mesh in meshes() {
        let topology = Topology::new(&mesh).unwrap();
        let mut stopped = 0;
        for vertex in (0..169).step_by(7) {
            for (worst, [dx, dy]) in [(2.0, [0.9, 0.4]), (1e4, [-0.8, 1.1]), (8.0, [0.05, -0.02])] {
                let device_mesh = app.mesh(&mesh);
                let at = app.points(&device_mesh);
                let to = [at[vertex][0] + dx, at[vertex][1] + dy].map(|x| x as f32);
                let targets = app.buffer(8, Usage::STORAGE | Usage::COPY_DST);
                let share = app.buffer(4, Usage::STORAGE | Usage::COPY_SRC);
                app.gpu.queue().write_buffer(&targets, 0, bytemuck::cast_slice(&to));
                let place = VertexBuffer::new(targets.slice(..), 8);
                let drag = device_mesh.bind_move(&[vertex as u32], &place, worst, share.slice(..));
                app.submit(|encoder| drag.unwrap().encode_move(encoder));
                let found = f64::from(f32::from_bits(app.read(&share)[0]));
                let mut expected = at.clone();
                let moves = [(vertex as u32, to.map(f64::from))];
                let of_host = topology.move_clamped(&mut expected, &moves, worst).unwrap();
                assert!((found - of_host).abs() <= 2e-4 * (of_host + 0.05), "{found} {of_host}");
                stopped += usize::from(of_host < 1.0);
                let moved = app.points(&device_mesh);
                assert_eq!(topology.bad_quadrilaterals(&moved), Ok(vec![]));
                assert!(topology::infeasible(&moved, &mesh.triangles).unwrap().is_empty());
            }
        }
        assert!(stopped > 20, "{stopped}");
    }
}

#[test]
fn tangled_quadrilaterals_are_turned_back() {
    let app = App::new();
    for lattice in [squares(12), mixed(12)] {
        let mesh = perturbed(&lattice, 1.2);
        let device_mesh = DeviceMesh::tangled(&app.gpu, &mesh).unwrap();
        let untangling = UntanglingSweeps::new(&device_mesh).unwrap();
        let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
        let topology = Topology::by_area(&mesh).unwrap();
        let bad = |points: &[[f64; 2]]| {
            let triangles = topology::infeasible(points, topology.triangles()).unwrap().len();
            triangles + topology.bad_quadrilaterals(points).unwrap().len()
        };
        let before = bad(&app.points(&device_mesh));
        assert!(before > 20);
        let found = app.objective(&sweeps);
        assert!(found.inverted as usize >= before && found.worst_imr.is_infinite());
        let frames = (1..80).find(|_| {
            app.submit(|encoder| {
                untangling.encode_untangle(encoder, 5);
                sweeps.encode_sweeps(encoder, 3);
            });
            app.objective(&sweeps).inverted == 0
        });
        assert!(frames.is_some(), "{} of {before} are left", bad(&app.points(&device_mesh)));
        assert_eq!(bad(&app.points(&device_mesh)), 0);
        // Valid meshes are not touched.
        let valid = app.points(&device_mesh);
        app.submit(|encoder| untangling.encode_untangle(encoder, 3));
        assert_eq!(app.points(&device_mesh), valid);
    }
}
