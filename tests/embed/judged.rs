//! Sweeps whose end the device determines.

use gpu_smooth::{
    Backend, Mesh, Method, Options, Smoother, Stop, Stopping,
    gpu::{DeviceMesh, ObjectiveValues, Sweeps, VertexBuffer},
    wgpu,
};
use wgpu::BufferUsages as Usage;

use crate::app::{App, Vertices, bad_plate, interior, plate};

/// An application that encodes sweeps in each frame and reads the objective.
struct Frames {
    app: App,
    mesh: Mesh,
    device_mesh: DeviceMesh,
    sweeps: Sweeps,
    vertices: Vertices,
}

impl Frames {
    fn new(mesh: Mesh, options: &Options) -> Self {
        let app = App::new();
        let device_mesh = app.mesh(&mesh);
        let sweeps = Sweeps::until_converged(&device_mesh, options).block().unwrap();
        let vertices = Vertices::usual(&app, &mesh);
        Self { app, mesh, device_mesh, sweeps, vertices }
    }

    /// Executes a frame: import, `count` sweeps, export. Returns the objective afterwards.
    fn frame(&mut self, count: u32) -> ObjectiveValues {
        let bound = self.vertices.bind(&self.device_mesh);
        self.app.submit(|encoder| {
            bound.encode_import(encoder);
            self.sweeps.encode_sweeps(encoder, count);
            bound.encode_export(encoder);
        });
        self.app.objective(&self.sweeps)
    }

    /// Executes frames until the sweeps have ended.
    fn end(&mut self) -> ObjectiveValues {
        let ended = (0..300).map(|_| self.frame(7)).find(|values| values.stop().is_some());
        ended.expect("the sweeps end")
    }

    fn points(&self) -> Vec<[f64; 2]> {
        self.app.points(&self.device_mesh)
    }
}

fn options() -> Options {
    Options::default().method(Method::RELAXED).stopping(Stopping::Tolerance(1e-3))
}

#[test]
fn sweeps_end_where_a_run_ends_however_they_are_split() {
    let mesh = plate(300);
    for (options, stop) in [
        (options(), Stop::Converged),
        (options().max_sweeps(5), Stop::MaxSweeps),
        (options().scheme("rms+imr".parse().unwrap()), Stop::Converged),
    ] {
        let app = App::new();
        let backend = Backend::Gpu(app.another_gpu());
        let run = Smoother::new(&mesh).unwrap();
        let run = run.run(&options).on(&backend).block().unwrap();
        assert_eq!(run.stop, stop);
        for each in [3, run.sweeps, run.sweeps + 3] {
            let mut frames = Frames::new(mesh.clone(), &options);
            let mut found = ObjectiveValues::default();
            let mut encoded = 0;
            while encoded < run.sweeps {
                assert_eq!((found.stop(), found.sweeps), (None, encoded));
                found = frames.frame(each);
                encoded += each;
            }
            assert_eq!((found.stop(), found.sweeps), (Some(stop), run.sweeps));
            assert_eq!(found.has_converged(), stop == Stop::Converged);
            let settled = frames.points();
            if run.best_sweep == run.sweeps {
                for (v, (e, f)) in run.points.iter().zip(&settled).enumerate() {
                    let same = (0..2).all(|x| (e[x] - f[x]).abs() < 1e-12);
                    assert!(same, "vertex {v}: {e:?} {f:?}");
                }
            }
            // After the end, sweeps change nothing.
            assert_eq!(frames.frame(each), found);
            assert_eq!(frames.points(), settled);
        }
    }
}

#[test]
fn a_change_of_the_mesh_begins_the_sweeps_anew() {
    let mut frames = Frames::new(bad_plate(300), &options());
    assert!(frames.end().has_converged());
    let v = interior(&frames.mesh)[30];
    let settled = frames.points();

    // Changes by the application: a moved vertex.
    let [x, y] = settled[v as usize];
    frames.vertices.put(&frames.app, v, [x + 1e-3, y]);
    let values = frames.frame(1);
    assert_eq!((values.stop(), values.sweeps), (None, 1));
    assert!(frames.end().has_converged());
    assert_ne!(frames.points(), settled);

    // A pinned or released vertex.
    frames.device_mesh.pin(&[v]).unwrap();
    assert_eq!(frames.app.objective(&frames.sweeps).stop(), None);
    assert_eq!(frames.frame(2).sweeps, 2);
    assert!(frames.end().has_converged());

    // A vertex moved toward a target, and later a vertex that has reached its target.
    let targets = frames.app.buffer(8, Usage::STORAGE | Usage::COPY_DST);
    let share = frames.app.buffer(4, Usage::STORAGE);
    let place = VertexBuffer::new(targets.slice(..), 8);
    let drag = frames.device_mesh.bind_move(&[v], &place, 8.0, share.slice(..)).unwrap();
    let [x, y] = frames.points()[v as usize].map(|x| x as f32);
    frames.app.gpu.queue().write_buffer(&targets, 0, bytemuck::cast_slice(&[x + 1e-3, y]));
    let dragged = || {
        frames.app.submit(|encoder| drag.encode_move(encoder));
        frames.app.objective(&frames.sweeps).stop()
    };
    assert_eq!(dragged(), None);
    // Exports without an import, which would return the vertex to its position in the buffer.
    let bound = frames.vertices.bind(&frames.device_mesh);
    frames.app.submit(|encoder| bound.encode_export(encoder));
    assert!(frames.end().has_converged());
    frames.app.submit(|encoder| drag.encode_move(encoder));
    assert!(frames.app.objective(&frames.sweeps).has_converged());

    frames.sweeps.restart();
    assert_eq!(frames.app.objective(&frames.sweeps).stop(), None);
    assert_eq!(frames.frame(3).sweeps, 3);
}

#[test]
fn two_schemes_on_one_mesh_are_each_judged_and_evaluations_in_between_do_not_count() {
    let mesh = bad_plate(300);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let mut alone = Sweeps::until_converged(&device_mesh, &options()).block().unwrap();
    app.submit(|encoder| alone.encode_sweeps(encoder, 40));
    let expected = app.objective(&alone);
    assert!(expected.has_converged() && expected.sweeps >= 16, "{expected:?}");

    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::until_converged(&device_mesh, &options()).block().unwrap();
    let other = options().scheme("rms".parse().unwrap());
    let mut other = Sweeps::until_converged(&device_mesh, &other).block().unwrap();
    let buffer = app.buffer(size_of::<ObjectiveValues>() as u64, Usage::STORAGE);
    let objective = sweeps.bind_objective(buffer.slice(..)).unwrap();
    app.submit(|encoder| {
        for _ in 0..40 {
            sweeps.encode_sweeps(encoder, 1);
            objective.encode_objective(encoder);
        }
    });
    assert_eq!(app.objective(&sweeps), expected);
    assert_eq!(app.objective(&other).sweeps, 0);
    app.submit(|encoder| other.encode_sweeps(encoder, 2));
    assert_eq!(app.objective(&other).sweeps, 2);
    // Sweeps of another scheme are no changes by the application.
    assert_eq!(app.objective(&sweeps).stop(), Some(Stop::Converged));
}

#[test]
fn sweeps_that_are_not_judged_have_no_stop() {
    let app = App::new();
    let device_mesh = app.mesh(&plate(300));
    let options = options().max_sweeps(1);
    let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
    app.submit(|encoder| sweeps.encode_sweeps(encoder, 5));
    let values = app.objective(&sweeps);
    assert_eq!((values.stop(), values.sweeps, values.has_converged()), (None, 0, false));
}
