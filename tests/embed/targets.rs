//! Targets of a mesh on an application's device.

use gpu_smooth::{
    Backend, Mesh, MeshError, Method, Metric, OptionError, Options, SmoothError, Smoother,
    Stopping, Targets, Topology,
    gpu::{DeviceMesh, Sweeps},
    options::{Derivatives, Feature, Paper},
    targets::Surface,
};

use crate::app::{App, bad_plate};

/// Returns target sizes that triple across the mesh.
fn growing(mesh: &Mesh) -> Targets {
    let across = |f: fn(f64, f64) -> f64, start| mesh.points.iter().map(|p| p[0]).fold(start, f);
    let (low, high) = (across(f64::min, f64::INFINITY), across(f64::max, f64::NEG_INFINITY));
    let size = |p: &[f64; 2]| 1.0 + 2.0 * (p[0] - low) / (high - low);
    Targets::sizes(&mesh.points.iter().map(size).collect::<Vec<_>>()).unwrap()
}

#[test]
fn encoded_sweeps_to_targets_are_those_of_a_run() {
    let plate = bad_plate(800);
    let growing = growing(&plate);
    let points = plate.points.iter().map(|[x, y]| [8.0 * x, *y]).collect();
    let stretched = Mesh { points, ..plate.clone() };
    let topology = Topology::new(&stretched).unwrap();
    let kept = Targets::keep_size(&topology, &stretched.points, Surface::Plane, 0).unwrap();
    assert!(kept.size_weight() > 2.0, "{}", kept.size_weight());
    for (mesh, targets) in [(&plate, growing), (&stretched, kept)] {
        assert_encoded_as_run(mesh, &targets);
    }
}

fn assert_encoded_as_run(mesh: &Mesh, targets: &Targets) {
    let app = App::new();
    let options = Options::default()
        .scheme(Metric::SoftSize.into())
        .method(Method::RELAXED)
        .max_sweeps(9)
        .stopping(Stopping::Tolerance(0.0));
    let mut smoother = Smoother::new(mesh).unwrap();
    smoother.set_targets(targets).unwrap();
    let backend = Backend::Gpu(app.another_gpu());
    let run = smoother.run(&options).on(&backend).block().unwrap();
    assert_eq!(run.best_sweep, 9);

    let device_mesh = DeviceMesh::with_targets(&app.gpu, mesh, targets).unwrap();
    let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
    app.submit(|encoder| sweeps.encode_sweeps(encoder, 9));
    let found = app.points(&device_mesh);
    let mut moved = 0;
    for (v, (there, here)) in run.points.iter().zip(&found).enumerate() {
        assert!((0..2).all(|x| (there[x] - here[x]).abs() < 1e-12), "{v}: {there:?} {here:?}");
        moved += usize::from(*there != mesh.points[v]);
    }
    assert!(moved > 100, "{moved}");
    let f = f64::from(app.objective(&sweeps).of(Metric::SoftSize));
    let expected = smoother.f(Metric::SoftSize, &found).unwrap();
    assert!((f / expected - 1.0).abs() < 1e-5, "{f} {expected}");

    // Without targets, equal sweeps lead to other positions.
    let plain = DeviceMesh::new(&app.gpu, mesh).unwrap();
    let mut sweeps = Sweeps::new(&plain, &options).block().unwrap();
    app.submit(|encoder| sweeps.encode_sweeps(encoder, 9));
    assert_ne!(app.points(&plain), found);
}

#[test]
fn targets_that_do_not_fit_are_refused() {
    let (app, mesh) = (App::new(), bad_plate(800));
    let error = DeviceMesh::with_targets(&app.gpu, &mesh, &Targets::equilateral(3)).err().unwrap();
    let expected = mesh.points.len();
    assert!(
        matches!(error, SmoothError::Mesh(MeshError::ValueCount { expected: e, given: 3 }) if e == expected)
    );
    let targets = Targets::equilateral(expected);
    let device_mesh = DeviceMesh::with_targets(&app.gpu, &mesh, &targets).unwrap();
    let differences = Paper { derivatives: Derivatives::FiniteDifference, ..Paper::default() };
    let options = Options::default().method(Method::Paper(differences));
    let error = Sweeps::new(&device_mesh, &options).block().err().unwrap();
    assert!(
        matches!(
            error,
            SmoothError::Option(OptionError::Conflict { features: [Feature::Targets, _], .. })
        ),
        "{error}"
    );
}

/// A smoother's preparation is reused, both with targets and with fixed vertices, which have another layout.
#[test]
fn a_mesh_from_a_smoother_is_swept_to_the_same_bits() {
    let app = App::new();
    let mut mesh = bad_plate(800);
    // An unused vertex.
    mesh.points.push([0.3, 0.4]);
    let targets = growing(&mesh);
    let inside = Smoother::new(&mesh).unwrap().topology().free().iter().position(|&free| free);
    let fixed = Mesh { fixed: vec![inside.unwrap() as u32], ..mesh.clone() };
    let options = Options::default().method(Method::RELAXED);
    for (mesh, with_targets) in [(&mesh, false), (&mesh, true), (&fixed, false), (&fixed, true)] {
        let mut smoother = Smoother::new(mesh).unwrap();
        let alone = match with_targets {
            true => DeviceMesh::with_targets(&app.gpu, mesh, &targets).unwrap(),
            false => DeviceMesh::new(&app.gpu, mesh).unwrap(),
        };
        if with_targets {
            smoother.set_targets(&targets).unwrap();
        }
        let taken = smoother.to_device(&app.gpu).unwrap();
        let swept = [&alone, &taken].map(|device_mesh| {
            let mut sweeps = Sweeps::new(device_mesh, &options).block().unwrap();
            app.submit(|encoder| sweeps.encode_sweeps(encoder, 6));
            app.points(device_mesh)
        });
        assert_eq!(swept[0], swept[1]);
        assert!(swept[0].iter().zip(&mesh.points).filter(|(a, b)| a != b).count() > 500);
    }
}
