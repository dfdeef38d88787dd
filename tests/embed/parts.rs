//! Meshes whose buffers exceed the device's largest binding. Bound in parts, they must be smoothed to the bits of
//! unlimited bindings.

use std::ops::ControlFlow;

use gpu_smooth::{
    Backend, Gpu, GpuError, Mesh, MeshSize, Method, Metric, Options, Outcome, Slide, Smoother,
    Stop,
    gpu::{DeviceMesh, Sweeps, UntanglingSweeps, VertexBuffer},
    wgpu,
};
use wgpu::Limits;

use crate::app::{App, Vertices, adapter, bad_plate, gpu_error, least_limits};
use support::lattice;

/// Largest binding of the small device, in bytes. The buffer of sums, which cannot be bound in parts, just fits: its
/// size grows with the number of metrics.
const BOUND: u64 = ((Metric::ALL.len() as u64 + 2) << 11) + (1 << 8);

/// Makes a mesh whose positions need two bindings on the small device, and its rings and triangles three each.
fn mesh() -> Mesh {
    bad_plate(2400)
}

fn size(mesh: &Mesh) -> MeshSize {
    MeshSize { vertices: mesh.points.len(), triangles: mesh.triangles.len() }
}

/// Opens a device that binds each buffer of the mesh as a whole, and a small device that needs parts.
fn devices(mesh: &Mesh) -> [App; 2] {
    let most = Limits { max_storage_buffer_binding_size: BOUND, ..adapter().limits() };
    let own = Limits::downlevel_webgl2_defaults();
    let own = Limits { max_storage_buffer_binding_size: 0, ..own };
    let small = Gpu::required_limits(own, size(mesh), &most).unwrap();
    assert_eq!(small.max_storage_buffer_binding_size, BOUND);
    // The Hessian of Newton steps takes twice as much, so neither device takes such steps.
    let bound = 24 * mesh.triangles.len() as u64;
    let whole = Limits { max_storage_buffer_binding_size: bound, ..least_limits(size(mesh)) };
    [whole, small].map(|limits| App::with_limits(limits).unwrap())
}

fn run(app: &App, mesh: &Mesh, options: &Options) -> Outcome {
    let backend = Backend::Gpu(app.another_gpu());
    let observe = &mut |_: &_| ControlFlow::Continue(());
    Smoother::new(mesh).unwrap().run(options).on(&backend).observe(observe).block().unwrap()
}

/// Returns the history of f by `metric`, starting before the first sweep.
fn f(outcome: &Outcome, metric: Metric) -> Vec<f64> {
    outcome.history.iter().map(|objectives| objectives.of(metric).unwrap()).collect()
}

#[test]
fn vertices_slide_to_the_same_places_part_by_part() {
    let mesh = mesh();
    let mut smoother = Smoother::new(&mesh).unwrap();
    assert!(smoother.set_slide(Some(&Slide::default())).unwrap() > 100);
    let options = Options::default()
        .method(Method::RELAXED)
        .scheme("imr+rms".parse().unwrap())
        .max_sweeps(20);
    let slid = devices(&mesh).map(|app| {
        let backend = Backend::Gpu(app.another_gpu());
        smoother.run(&options).on(&backend).block().unwrap()
    });
    assert!(slid[0].slid.unwrap().moved > 100);
    assert_eq!(slid[0].points, slid[1].points);
}

#[test]
fn a_run_is_the_same_part_by_part() {
    let mesh = mesh();
    let devices = devices(&mesh);
    let sweeps = |scheme: &str| {
        Options::default()
            .scheme(scheme.parse().unwrap())
            .method(Method::RELAXED)
            .max_sweeps(30)
            .track_all(true)
    };
    let names = Metric::ALL.iter().map(|metric| metric.name());
    let alone = names.map(sweeps);
    // In these two schemes, the best sweep is not the last.
    let others = ["edge+imr", "imr+area"].map(sweeps);
    for options in alone.chain(others) {
        let [whole, parts] = devices.each_ref().map(|app| run(app, &mesh, &options));
        let name = options.scheme.to_string();
        assert_eq!(whole.history, parts.history, "{name}");
        assert_eq!((whole.sweeps, whole.best_sweep), (parts.sweeps, parts.best_sweep), "{name}");
        assert!(whole.points == parts.points, "{name}");
        assert!(whole.best_sweep > 0 && whole.points != mesh.points, "{name}");
    }
}

#[test]
fn an_application_gets_the_same_results_part_by_part() {
    let mesh = mesh();
    let found = devices(&mesh).map(|app| {
        let device_mesh = app.mesh(&mesh);
        let held: Vec<u32> = (0..mesh.points.len() as u32).step_by(17).collect();
        device_mesh.pin(&held).unwrap();
        let mut sweeps =
            Sweeps::until_converged(&device_mesh, &Options::default()).block().unwrap();
        let vertices = Vertices::new(&app, &mesh, 0, 8);
        let bound = vertices.bind(&device_mesh);
        let words: Vec<u32> =
            (0..mesh.points.len() as u32).map(|v| u32::from(v % 13 == 0)).collect();
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
        let [mask, targets] =
            [4, 8].map(|bytes| app.buffer(bytes * mesh.points.len() as u64, usage));
        app.gpu.queue().write_buffer(&mask, 0, bytemuck::cast_slice(&words));
        let mask = device_mesh.bind_mask(mask.slice(..)).unwrap();
        // All dragged vertices move toward a common point, until triangles stop them.
        let to = vec![[1.0f32, 1.0]; mesh.points.len()];
        app.gpu.queue().write_buffer(&targets, 0, bytemuck::cast_slice(&to));
        let share = app.buffer(4, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
        let place = VertexBuffer::new(targets.slice(..), 8);
        let moved: Vec<u32> = (0..mesh.points.len() as u32).step_by(41).collect();
        let drag = device_mesh.bind_move(&moved, &place, 1e4, share.slice(..)).unwrap();
        // An import applies the move of a plate's corner.
        vertices.put(&app, 0, [-0.125, -0.25]);
        let last_valid = device_mesh.keep_last_valid().unwrap();
        let all: Vec<u32> = (0..mesh.points.len() as u32).collect();
        if let Err(error) = device_mesh.bind_move(&all, &place, 1e4, share.slice(..)) {
            let text = "triangles around moved vertices needs";
            assert!(error.to_string().contains(text), "{error}");
            assert!(matches!(gpu_error(error), GpuError::Limit { .. }));
        }
        app.submit(|encoder| {
            bound.encode_import(encoder);
            mask.encode_mask(encoder);
            drag.encode_move(encoder);
            sweeps.encode_sweeps(encoder, 10);
            last_valid.encode_restore_last_valid(encoder);
            bound.encode_export(encoder);
        });
        let before = app.points(&device_mesh);
        // A vertex is moved out of the plate and restored.
        vertices.put(&app, 300, [9.0, 9.0]);
        app.submit(|encoder| {
            bound.encode_import(encoder);
            last_valid.encode_restore_last_valid(encoder);
            bound.encode_export(encoder);
        });
        assert!(app.points(&device_mesh) == before);
        // The vertex is moved out again, and the mesh is untangled. A corner is moved to a position that untangling
        // cannot repair.
        let untangling = UntanglingSweeps::new(&device_mesh).unwrap();
        vertices.put(&app, 300, [9.0, 9.0]);
        vertices.put(&app, 0, [2.0, 1.5]);
        app.submit(|encoder| {
            bound.encode_import(encoder);
            untangling.encode_untangle(encoder, 12);
            bound.encode_export(encoder);
        });
        assert!(app.points(&device_mesh) != before);
        let f = app.objective(&sweeps);
        let share = f32::from_bits(app.read(&share)[0]);
        assert!(share > 0.0 && share < 1.0, "{share}");
        (app.read(&vertices.buffer), app.points(&device_mesh), f, share)
    });
    assert!(found[0] == found[1]);
    assert_ne!(found[0].1, mesh.points);
}

#[test]
fn a_mesh_that_cannot_be_bound_in_parts_is_refused_before_anything_is_allocated() {
    // A mesh whose positions would need three bindings.
    let side = ((BOUND / 8) as f64).sqrt() as usize + 1;
    let large = lattice(side - 1, side - 1);
    let [_, app] = devices(&mesh());
    let error = app.gpu.check_size(size(&large)).unwrap_err();
    let text = format!(
        "the buffer of vertex positions ({} vertices) needs {}, \
         but the device's max_storage_buffer_binding_size is {BOUND}",
        side * side,
        8 * side * side,
    );
    assert_eq!(error.to_string(), text);
    // Counts allocations after a poll, in which the device frees unused memory.
    let made = || {
        app.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
        app.device().generate_allocator_report().map(|report| report.allocations.len())
    };
    let before = made();
    assert_eq!(gpu_error(DeviceMesh::new(&app.gpu, &large).err().unwrap()).to_string(), text);
    let backend = Backend::Gpu(app.another_gpu());
    let smoother = Smoother::new(&large).unwrap();
    for method in [Method::RELAXED, Method::Auto] {
        let options = Options::default().method(method);
        let run = smoother.run(&options).on(&backend).block();
        assert_eq!(gpu_error(run.unwrap_err()).to_string(), text);
    }
    assert_eq!(made(), before);
    app.gpu.check_size(size(&mesh())).unwrap();
}

#[test]
fn a_device_of_few_bindings_takes_no_positions_in_two() {
    let mesh = mesh();
    let few = Limits { max_storage_buffers_per_shader_stage: 7, ..adapter().limits() };
    let few = Limits { max_storage_buffer_binding_size: BOUND, ..few };
    let own = Limits::downlevel_webgl2_defaults();
    let error = Gpu::required_limits(own.clone(), size(&mesh), &few).unwrap_err();
    assert_eq!(
        error.to_string(),
        format!(
            "a kernel that binds positions in two ({} vertices) needs 8, \
             but the device's max_storage_buffers_per_shader_stage is 7",
            mesh.points.len()
        )
    );
    let less = size(&bad_plate(900));
    let limits = Gpu::required_limits(own, less, &few).unwrap();
    assert_eq!(limits.max_storage_buffers_per_shader_stage, 7);
    let app = App::with_limits(limits).unwrap();
    assert!(matches!(app.gpu.check_size(size(&mesh)), Err(GpuError::Limit { available: 7, .. })));
}

#[test]
fn corrections_are_the_same_part_by_part() {
    let mesh = mesh();
    let devices = devices(&mesh);
    for metric in [Metric::Imr, Metric::Rms] {
        let method = Method::Multilevel;
        let options = Options::default().scheme(metric.into()).method(method);
        let [whole, parts] = devices.each_ref().map(|app| run(app, &mesh, &options));
        assert!(whole.corrections > 3, "{metric}");
        assert_eq!(f(&whole, metric), f(&parts, metric));
        assert!(whole.points == parts.points, "{metric}");
        assert!(!parts.levels_left_out);
    }
}

#[test]
fn corrections_are_left_out_where_coarser_levels_do_not_fit() {
    // The only coarse level has some 80 unknowns, whose inverse matrix exceeds a binding of the device.
    let mesh = bad_plate(870);
    let [large, small] = devices(&self::mesh());
    // By this metric, runs do not end by Newton steps.
    let auto = Options::default().scheme(Metric::ShapeSize.into());
    let [with, without] = [&large, &small].map(|app| run(app, &mesh, &auto));
    assert!(with.corrections > 0 && !with.levels_left_out);
    assert!(without.corrections == 0 && without.levels_left_out);
    assert_eq!(without.stop, Stop::Converged);
    let [with, without] =
        [with, without].map(|outcome| *f(&outcome, Metric::ShapeSize).last().unwrap());
    assert!((without / with - 1.0).abs() < 1e-6, "{without} for {with}");

    let asked = auto.method(Method::Multilevel);
    let backend = Backend::Gpu(small.another_gpu());
    let observe = &mut |_: &_| ControlFlow::Continue(());
    let error = Smoother::new(&mesh)
        .unwrap()
        .run(&asked)
        .on(&backend)
        .observe(observe)
        .block()
        .unwrap_err();
    assert!(matches!(gpu_error(error), GpuError::Limit { available: BOUND, .. }));
}

#[test]
fn encoded_corrections_are_the_same_part_by_part() {
    // For `mesh()`, the vectors of the levels would exceed a binding of the small device, so the mesh is smaller.
    let mesh = bad_plate(1500);
    let points = devices(&mesh).each_ref().map(|app| {
        let device_mesh = app.mesh(&mesh);
        let options = Options::default().method(Method::Multilevel);
        let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
        app.submit(|encoder| sweeps.encode_sweeps(encoder, 3));
        app.points(&device_mesh)
    });
    assert!(points[0] == points[1] && points[0] != mesh.points);
}
