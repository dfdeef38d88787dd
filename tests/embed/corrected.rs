//! Encoded sweeps with corrections from coarser levels, whose line search runs on the device.

use gpu_smooth::{
    Backend, Mesh, Method, Metric, OptionError, Options, SmoothError, Smoother, Stopping, Targets,
    gpu::{DeviceMesh, Doubt, ObjectiveValues, Sweeps},
    options::Relaxed,
    wgpu,
};
use wgpu::BufferUsages as Usage;

use crate::app::{App, Vertices, bad_plate, interior, plate};
use support::{distort_smooth, graded, lattice, orientations, perturb_random, read_mesh};

fn corrected(metric: Metric) -> Options {
    Options::default().scheme(metric.into()).method(Method::Multilevel)
}

/// Returns options without corrections, but with the relaxation of corrected sweeps.
fn alone() -> Options {
    let relaxed = Relaxed { omega: Some(1.3), unrelaxed_sweeps: 0 };
    Options::default().method(Method::Relaxed(relaxed))
}

/// Makes a mesh displaced by long waves, for which uncorrected sweeps converge slowly.
fn distorted() -> Mesh {
    distort_smooth(&plate(1200), 0.5)
}

/// Executes `count` frames of one sweep each. Returns f after each frame, and the final points.
fn frames(mesh: &Mesh, options: &Options, count: usize) -> (Vec<f64>, Vec<[f64; 2]>) {
    let app = App::new();
    let device_mesh = app.mesh(mesh);
    let mut sweeps = Sweeps::new(&device_mesh, options).block().unwrap();
    let mut f = Vec::new();
    for _ in 0..count {
        app.submit(|encoder| sweeps.encode_sweeps(encoder, 1));
        let values = app.objective(&sweeps);
        assert_eq!(values.inverted, 0);
        f.push(values.of(options.scheme.base()).into());
    }
    (f, app.points(&device_mesh))
}

/// Returns the smallest f found by a run on the CPU.
fn limit(mesh: &Mesh, metric: Metric) -> f64 {
    let options = Options::default().scheme(metric.into()).stopping(Stopping::Tolerance(1e-8));
    let run = Smoother::new(mesh).unwrap();
    let run = run.run(&options).on(&Backend::Cpu).block().unwrap();
    run.history.last().and_then(|f| f.of(metric)).unwrap()
}

#[test]
fn corrected_sweeps_are_near_the_limit_after_a_dozen_and_never_raise_f() {
    let mesh = distorted();
    for metric in [Metric::Imr, Metric::Rms, Metric::ShapeSize] {
        let (f, points) = frames(&mesh, &corrected(metric), 15);
        let limit = limit(&mesh, metric);
        let left = f[14] / limit - 1.0;
        assert!(left < 1e-5, "{metric}: {left} left of {limit}: {f:?}");
        // f may rise only by rounding in single precision.
        assert!(f.windows(2).all(|f| f[1] <= f[0] * (1.0 + 2e-7)), "{metric}: {f:?}");
        let end = Mesh { points, ..mesh.clone() };
        assert!(orientations(&end).iter().all(|&sign| sign == 1));
        let plain = corrected(metric).method(Method::RELAXED);
        let (f, _) = frames(&mesh, &plain, 15);
        assert!(f[14] / limit - 1.0 > 10.0 * left.max(1e-7), "{metric}: {f:?}");
    }
}

#[test]
fn a_badly_perturbed_mesh_is_corrected_too() {
    let mesh = bad_plate(1200);
    let (f, _) = frames(&mesh, &corrected(Metric::Imr), 40);
    assert!(f.windows(2).all(|f| f[1] <= f[0] * (1.0 + 2e-7)), "{f:?}");
    assert!(f[39] / limit(&mesh, Metric::Imr) - 1.0 < 1e-5, "{f:?}");
}

#[test]
fn a_tangled_mesh_is_swept_as_without_corrections() {
    let mesh = distorted();
    let mut ends = Vec::new();
    for options in [corrected(Metric::Imr), alone()] {
        let app = App::new();
        let device_mesh = app.mesh(&mesh);
        let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
        let vertices = Vertices::usual(&app, &mesh);
        let bound = vertices.bind(&device_mesh);
        let v = interior(&mesh)[200];
        let [x, y] = mesh.points[v as usize];
        vertices.put(&app, v, [x + 0.6, y]);
        app.submit(|encoder| {
            bound.encode_import(encoder);
            sweeps.encode_sweeps(encoder, 5);
        });
        assert!(app.objective(&sweeps).inverted > 0);
        ends.push(app.points(&device_mesh));
        // After the vertex has returned, the mesh is corrected again.
        vertices.put(&app, v, [x, y]);
        app.submit(|encoder| {
            bound.encode_import(encoder);
            sweeps.encode_sweeps(encoder, 5);
        });
        assert_eq!(app.objective(&sweeps).inverted, 0);
        ends.push(app.points(&device_mesh));
    }
    assert!(ends[0] == ends[2]);
    assert!(ends[1] != ends[3]);
}

#[test]
fn corrections_that_gain_nothing_change_no_bit() {
    // In a mesh of equilateral triangles, neither sweeps nor corrections gain anything.
    let mesh = lattice(30, 30);
    let (f, points) = frames(&mesh, &corrected(Metric::Imr), 3);
    assert!((f[2] - 1.0).abs() < 1e-6);
    let (_, before) = frames(&mesh, &alone(), 3);
    assert!(points == before);
}

#[test]
fn vertices_that_are_pinned_or_masked_stay_and_others_are_corrected_around_them() {
    let mesh = distorted();
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let before = app.points(&device_mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &corrected(Metric::Imr)).block().unwrap();
    let inside = interior(&mesh);
    let pinned: Vec<u32> = inside.iter().copied().step_by(50).collect();
    device_mesh.pin(&pinned).unwrap();
    let mut words = vec![0u32; mesh.points.len()];
    let masked: Vec<u32> = inside.iter().copied().skip(7).step_by(50).collect();
    masked.iter().for_each(|&v| words[v as usize] = 1);
    let buffer = app.buffer(4 * words.len() as u64, Usage::STORAGE | Usage::COPY_DST);
    app.gpu.queue().write_buffer(&buffer, 0, bytemuck::cast_slice(&words));
    let mask = device_mesh.bind_mask(buffer.slice(..)).unwrap();
    let first = app.objective(&sweeps).of(Metric::Imr);
    app.submit(|encoder| {
        mask.encode_mask(encoder);
        sweeps.encode_sweeps(encoder, 1);
    });
    let after_one = app.objective(&sweeps).of(Metric::Imr);
    app.submit(|encoder| sweeps.encode_sweeps(encoder, 14));
    let held = app.points(&device_mesh);
    for v in pinned.iter().chain(&masked).map(|&v| v as usize) {
        assert_eq!(held[v], before[v], "vertex {v}");
    }
    let values = app.objective(&sweeps);
    assert!(values.of(Metric::Imr) < after_one && after_one < first && values.inverted == 0);
    // f must equal the limit of uncorrected sweeps with equal held vertices.
    let mut alone = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    app.submit(|encoder| alone.encode_sweeps(encoder, 200));
    let end = app.objective(&sweeps).of(Metric::Imr);
    assert!(values.of(Metric::Imr) / end - 1.0 < 1e-4, "{values:?} {end}");
    assert!(app.points(&device_mesh) != held);
}

#[test]
fn judged_sweeps_with_corrections_end_sooner_and_then_leave_every_bit() {
    let mesh = distorted();
    let app = App::new();
    let mut counts = Vec::new();
    for method in [Method::Multilevel, Method::RELAXED] {
        let device_mesh = app.mesh(&mesh);
        let options = Options::default().method(method).stopping(Stopping::Tolerance(1e-5));
        let mut sweeps = Sweeps::until_converged(&device_mesh, &options).block().unwrap();
        app.submit(|encoder| sweeps.encode_sweeps(encoder, 120));
        let values = app.objective(&sweeps);
        assert!(values.has_converged(), "{values:?}");
        let settled = app.points(&device_mesh);
        app.submit(|encoder| sweeps.encode_sweeps(encoder, 3));
        assert_eq!(app.objective(&sweeps), values);
        assert!(app.points(&device_mesh) == settled);
        counts.push((values.sweeps, f64::from(values.of(Metric::Imr))));
    }
    assert!(counts[0].0 < counts[1].0, "{counts:?}");
    let limit = limit(&mesh, Metric::Imr);
    assert!(counts.iter().all(|(_, f)| f / limit - 1.0 < 1e-5), "{counts:?} {limit}");
}

#[test]
fn meshes_in_one_encoder_and_in_a_pass_are_corrected_as_alone() {
    let meshes = [distorted(), bad_plate(400)];
    let options = corrected(Metric::Imr);
    let expected = meshes.each_ref().map(|mesh| frames(mesh, &options, 4).1);
    for in_a_pass in [false, true] {
        let app = App::new();
        let device_meshes = meshes.each_ref().map(|mesh| app.mesh(mesh));
        let mut sweeps =
            device_meshes.each_ref().map(|mesh| Sweeps::new(mesh, &options).block().unwrap());
        app.submit(|encoder| {
            if in_a_pass {
                let mut pass = encoder.begin_compute_pass(&Default::default());
                for _ in 0..4 {
                    sweeps.iter_mut().for_each(|sweeps| sweeps.encode_sweeps(&mut pass, 1));
                }
            } else {
                sweeps.iter_mut().for_each(|sweeps| sweeps.encode_sweeps(encoder, 4));
            }
        });
        let found = device_meshes.each_ref().map(|mesh| app.points(mesh));
        assert!(found == expected);
    }
}

#[test]
fn a_mesh_with_targets_is_corrected_as_they_show_it() {
    let mesh = distorted();
    let stretched = vec![[4.0, 0.0, 1.0]; mesh.points.len()];
    let targets = Targets::tensors(&stretched).unwrap();
    let app = App::new();
    let f = [Method::Multilevel, Method::RELAXED].map(|method| {
        let device_mesh = DeviceMesh::with_targets(&app.gpu, &mesh, &targets).unwrap();
        let options = Options::default().method(method);
        let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
        let counts = if method == Method::Multilevel { [25, 275] } else { [25, 400] };
        counts.map(|count| {
            app.submit(|encoder| sweeps.encode_sweeps(encoder, count));
            f64::from(app.objective(&sweeps).of(Metric::Imr))
        })
    });
    let end = f[0][1].min(f[1][1]);
    assert!(f[0][0] / end - 1.0 < 0.1 * (f[1][0] / end - 1.0), "{f:?}");
}

/// A former defect: corrected sweeps took several times as long as sweeps alone on stretched meshes and around hubs, and said
/// nothing where they converged too early.
#[test]
fn stretched_meshes_and_hubs_are_swept_without_corrections_and_say_why() {
    let mut stretched = perturb_random(&lattice(30, 20), 0.5, 3);
    stretched.points.iter_mut().for_each(|point| point[1] /= 10.0);
    let hub = perturb_random(&support::hub_evenly(300, 6), 0.3, 3);
    let plain = Options::default().scheme(Metric::Imr.into());
    for (mesh, doubt) in [(&stretched, Doubt::Stretched), (&hub, Doubt::Hub(300))] {
        let app = App::new();
        let made = |options| Sweeps::new(&app.mesh(mesh), options).block().unwrap().doubt();
        assert_eq!([made(&plain), made(&corrected(Metric::Imr))], [Some(doubt); 2]);
        assert_eq!(frames(mesh, &plain, 3), frames(mesh, &corrected(Metric::Imr), 3));
    }
    let app = App::new();
    let targets = Targets::tensors(&vec![[1.0, 0.0, 100.0]; stretched.points.len()]).unwrap();
    let fitting = DeviceMesh::with_targets(&app.gpu, &stretched, &targets).unwrap();
    for device_mesh in [fitting, app.mesh(&distorted())] {
        let sweeps =
            Sweeps::until_converged(&device_mesh, &corrected(Metric::Imr)).block().unwrap();
        assert_eq!(sweeps.doubt(), None);
    }
}

#[test]
fn meshes_without_coarser_levels_are_swept() {
    let square = Mesh {
        points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.7, 0.4]],
        triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
        ..Mesh::default()
    };
    let (_, points) = frames(&square, &corrected(Metric::Imr), 20);
    assert!(points[4].iter().all(|x| (x - 0.5).abs() < 1e-4), "{points:?}");
    let (f, _) = frames(&bad_plate(102), &corrected(Metric::Imr), 10);
    assert!(f[9] < f[0], "{f:?}");
}

#[test]
fn meshes_and_options_that_cannot_be_corrected_are_refused_with_the_reason() {
    let app = App::new();
    let device_mesh = app.mesh(&plate(102));
    let multilevel = |scheme: &str| {
        Options::default().scheme(scheme.parse().unwrap()).method(Method::Multilevel)
    };
    for (options, reason) in [
        (multilevel("edge"), "encoding corrected sweeps does not go with a scheme of several"),
        (multilevel("imr+rms"), "encoding corrected sweeps does not go with a scheme of"),
        (multilevel("area"), "cannot be corrected from coarser levels; take another metric"),
    ] {
        let error = Sweeps::new(&device_mesh, &options).block().err().unwrap();
        assert!(matches!(error, SmoothError::Option(OptionError::Conflict { .. })), "{error:?}");
        assert!(error.to_string().contains(reason), "{error}");
    }
}

#[test]
fn corrected_sweeps_made_without_blocking_are_the_same() {
    let mesh = distorted();
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let options = corrected(Metric::Imr);
    let mut made = std::pin::pin!(Sweeps::new(&device_mesh, &options).into_future());
    let mut context = std::task::Context::from_waker(std::task::Waker::noop());
    let mut sweeps = loop {
        match made.as_mut().poll(&mut context) {
            std::task::Poll::Ready(sweeps) => break sweeps.unwrap(),
            std::task::Poll::Pending => {
                app.device().poll(wgpu::PollType::Poll).unwrap();
            }
        }
    };
    app.submit(|encoder| sweeps.encode_sweeps(encoder, 4));
    assert!(app.points(&device_mesh) == frames(&mesh, &options, 4).1);
}

#[test]
fn encoding_frame_after_frame_allocates_nothing() {
    let app = App::new();
    let device_mesh = app.mesh(&plate(300));
    let mut sweeps = Sweeps::new(&device_mesh, &corrected(Metric::Imr)).block().unwrap();
    let buffer = app.buffer(size_of::<ObjectiveValues>() as u64, Usage::STORAGE);
    let objective = sweeps.bind_objective(buffer.slice(..)).unwrap();
    let mut made = Vec::new();
    for _ in 0..40 {
        app.submit(|encoder| {
            sweeps.encode_sweeps(encoder, 2);
            objective.encode_objective(encoder);
        });
        app.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
        let report = app.device().generate_allocator_report().expect("a backend that reports");
        made.push((report.allocations.len(), report.total_allocated_bytes));
    }
    assert!(made[10..].windows(2).all(|pair| pair[0] == pair[1]), "{made:?}");
}

#[test]
fn levels_are_fitted_to_a_mesh_whose_sizes_have_changed() {
    // At upload, elements at one end are a nineteenth as wide as at the other.
    let mesh = distorted();
    let graded = |&[x, y]: &[f64; 2]| [x * (0.1 + 0.3 * x), y];
    let uploaded = Mesh { points: mesh.points.iter().map(graded).collect(), ..mesh.clone() };
    let app = App::new();
    let device_mesh = app.mesh(&uploaded);
    let mut sweeps = Sweeps::new(&device_mesh, &corrected(Metric::Imr)).block().unwrap();
    let vertices = Vertices::usual(&app, &mesh);
    let bound = vertices.bind(&device_mesh);
    app.submit(|encoder| {
        bound.encode_import(encoder);
        sweeps.encode_sweeps(encoder, 15);
    });
    let left = f64::from(app.objective(&sweeps).of(Metric::Imr)) / limit(&mesh, Metric::Imr) - 1.0;
    assert!(left < 1e-5, "{left}");
}

/// Levels built for the triangles of a rough mesh never fit the mesh that sweeps make of it: a former defect.
#[test]
fn a_rough_mesh_is_near_the_limit_after_a_dozen_corrected_sweeps() {
    let meshes = support::meshes();
    let fish = read_mesh(&meshes.join("fish.node"));
    let cases = [
        ("plate", read_mesh(&meshes.join("plate.node"))),
        ("fish", perturb_random(&fish, 1.0, 2)),
        ("ring", perturb_random(&graded(150, 0.3), 1.0, 1)),
    ];
    for (name, mesh) in &cases {
        let limit = limit(mesh, Metric::Imr);
        let count = |options: &Options| {
            let (f, _) = frames(mesh, options, 60);
            f.iter().position(|f| f / limit - 1.0 < 1e-5).map_or(usize::MAX, |frame| frame + 1)
        };
        let plain = corrected(Metric::Imr).method(Method::RELAXED);
        let [with, without] = [corrected(Metric::Imr), plain].map(|options| count(&options));
        assert!(with <= 14 && with < without, "{name}: {with} and {without}");
    }
}
