//! Encoded sweeps give the result of a run, however they are divided and interleaved.

use gpu_smooth::{
    Backend, Mesh, Method, Options, Smoother, Stopping,
    gpu::Sweeps,
    options::{Derivatives, PNormExponent, Paper, Relaxed},
    wgpu::CommandEncoder,
};

use crate::app::{App, bad_plate, plate};
use support::{lattice, perturb_random};

fn options(scheme: &str) -> Options {
    let method = Method::RELAXED;
    Options::default().scheme(scheme.parse().unwrap()).method(method)
}

/// Runs `sweeps` sweeps on the GPU. Returns the best points, and the number of the sweep that produced them.
fn run(mesh: &Mesh, options: &Options, sweeps: u32) -> (Vec<[f64; 2]>, u32) {
    let app = App::new();
    let backend = Backend::Gpu(app.another_gpu());
    let options = options.clone().max_sweeps(sweeps).stopping(Stopping::Tolerance(0.0));
    let outcome = Smoother::new(mesh).unwrap().run(&options).on(&backend).block().unwrap();
    assert_eq!((outcome.sweeps, outcome.returned), (sweeps, 0));
    (outcome.points, outcome.best_sweep)
}

/// Returns the mesh, perturbed until a triangle exceeds the shape guards of all metrics. Below the guard of a metric, a
/// run would use the worst triangle of its mesh as the guard, unlike encoded sweeps, whose mesh may change.
fn flattened(mesh: &Mesh) -> Mesh {
    let mesh = perturb_random(mesh, 1.0, 1);
    assert!(support::worst_imr(&mesh) > 30.0);
    mesh
}

/// Checks that vertices agree: moved ones bit by bit, others to the 48 bits of the device.
fn assert_same(name: &str, mesh: &Mesh, expected: &[[f64; 2]], found: &[[f64; 2]]) {
    let mut moved = 0;
    for (v, (e, f)) in expected.iter().zip(found).enumerate() {
        if *e == mesh.points[v] {
            assert!((0..2).all(|x| (e[x] - f[x]).abs() < 1e-12), "{name}: vertex {v}: {e:?} {f:?}");
        } else {
            assert_eq!(e, f, "{name}: vertex {v}");
            moved += 1;
        }
    }
    assert!(moved > 100, "{name}: only {moved} vertices moved");
}

#[test]
fn encoded_sweeps_are_those_of_a_run() {
    let mesh = flattened(&plate(800));
    let relaxed = |omega, unrelaxed_sweeps| Method::Relaxed(Relaxed { omega, unrelaxed_sweeps });
    let two_steps = Paper { newton_steps: 2, ..Paper::default() };
    let differences = Paper { derivatives: Derivatives::FiniteDifference, ..Paper::default() };
    let cases = [
        ("over-relaxed after four", options("imr"), 13),
        ("over-relaxed after six", options("imr").method(relaxed(None, 6)), 9),
        ("as published", Options::paper("imr".parse().unwrap()), 6),
        ("alternating", options("edge+imr"), 7),
        ("alternating by three", options("imr+rms+area").method(relaxed(Some(1.3), 2)), 8),
        ("two steps a visit", options("imr").method(Method::Paper(two_steps)), 6),
        ("sharpened", options("edge").edge_norm(Some(PNormExponent::CONTINUED)), 12),
        ("by differences", options("rms").method(Method::Paper(differences)), 6),
        ("all tracked", options("area").track_all(true), 6),
    ];
    for (name, options, sweeps) in cases {
        let (expected, sweeps) = run(&mesh, &options, sweeps);
        assert!(sweeps > 4, "{name}: best after {sweeps}");

        let app = App::new();
        let device_mesh = app.mesh(&mesh);
        let mut encoded = Sweeps::new(&device_mesh, &options).block().unwrap();
        // Three calls in one command buffer, one of them without sweeps; the rest in other command buffers.
        app.submit(|encoder| [1, 0, 2].into_iter().for_each(|n| encoded.encode_sweeps(encoder, n)));
        app.submit(|encoder| encoded.encode_sweeps(encoder, 1));
        app.submit(|encoder| encoded.encode_sweeps(encoder, sweeps - 4));
        let found = app.points(&device_mesh);
        assert_same(name, &mesh, &expected, &found);
    }
}

#[test]
fn two_meshes_and_two_schemes_in_one_encoder_do_as_alone() {
    let (plate, other) = (bad_plate(700), flattened(&lattice(20, 17)));
    let (imr, edge) = (options("imr"), options("edge+imr"));
    let (first_expected, _) = run(&plate, &imr, 9);
    let (second_expected, best) = run(&other, &edge, 6);
    assert_eq!(best, 6);

    let app = App::new();
    let meshes = [app.mesh(&plate), app.mesh(&other)];
    let mut first = Sweeps::new(&meshes[0], &imr).block().unwrap();
    let mut second = Sweeps::new(&meshes[1], &edge).block().unwrap();
    app.submit(|encoder| {
        for _ in 0..3 {
            first.encode_sweeps(encoder, 3);
            second.encode_sweeps(encoder, 2);
        }
    });
    assert_same("first", &plate, &first_expected, &app.points(&meshes[0]));
    assert_same("second", &other, &second_expected, &app.points(&meshes[1]));
}

#[test]
fn two_schemes_take_turns_on_one_mesh() {
    let mesh = bad_plate(700);
    let app = App::new();
    // A single submission for all calls, and a submission per call.
    let [together, apart] = [true, false].map(|together| {
        let device_mesh = app.mesh(&mesh);
        let bind = |scheme| Sweeps::new(&device_mesh, &options(scheme)).block().unwrap();
        let (mut imr, mut edge) = (bind("imr"), bind("edge"));
        let mut turn = |encoder: &mut CommandEncoder| {
            imr.encode_sweeps(encoder, 2);
            edge.encode_sweeps(encoder, 1);
        };
        if together {
            app.submit(|encoder| (0..4).for_each(|_| turn(encoder)));
        } else {
            (0..4).for_each(|_| app.submit(&mut turn));
        }
        app.points(&device_mesh)
    });
    assert_same("in turn", &mesh, &apart, &together);
    assert_ne!(together, run(&mesh, &options("imr"), 12).0);
}

#[test]
fn a_restarted_scheme_starts_with_plain_sweeps_again() {
    let mesh = bad_plate(700);
    let app = App::new();
    let options = options("imr+rms");
    let relaxed = Relaxed { omega: Some(1.6), ..Relaxed::default() };
    let options = options.method(Method::Relaxed(relaxed));
    // Seven sweeps, then seven more: after a restart, with new sweeps, or continued.
    let [restarted, anew, on] = [0, 1, 2].map(|case| {
        let device_mesh = app.mesh(&mesh);
        let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
        app.submit(|encoder| sweeps.encode_sweeps(encoder, 7));
        match case {
            0 => sweeps.restart(),
            1 => sweeps = Sweeps::new(&device_mesh, &options).block().unwrap(),
            _ => {}
        }
        app.submit(|encoder| sweeps.encode_sweeps(encoder, 7));
        app.points(&device_mesh)
    });
    assert_same("restarted", &mesh, &anew, &restarted);
    assert_ne!(anew, on);
}

#[test]
fn sweeps_outlive_the_mesh_they_are_bound_to() {
    let mesh = bad_plate(700);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    drop(device_mesh);
    app.submit(|encoder| sweeps.encode_sweeps(encoder, 3));
    app.device().poll(gpu_smooth::wgpu::PollType::wait_indefinitely()).unwrap();
}
