//! Runs that are canceled between two sweeps and continued later.

use std::ops::ControlFlow;
use std::time::Duration;

use gpu_smooth::{
    Backend, Checkpoint, CheckpointPolicy, Goal, Method, Metric, Options, Outcome, Progress,
    Quality, Slide, SmoothError, Smoother, Stop, Stopping, TargetField, Targets, Topology,
    options::{Relaxed, WorstBy},
    targets::Surface,
};

use super::flat::{bent, pressed_to_a_line};
use super::{all_schemes, backends, name, perturbed, plate, stuck, with_points};

/// A policy that collects all checkpoints.
#[derive(Default)]
struct All(Vec<Checkpoint>);

impl CheckpointPolicy for All {
    fn wants_checkpoint(&mut self, _: bool) -> bool {
        true
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) {
        let bytes = checkpoint.to_bytes();
        self.0.push(Checkpoint::from_bytes(&bytes).unwrap());
    }
}

#[track_caller]
fn assert_same(a: &Outcome, b: &Outcome, what: &str) {
    let bits = |outcome: &Outcome| -> Vec<[u64; 2]> {
        outcome.points.iter().map(|point| point.map(f64::to_bits)).collect()
    };
    assert!(bits(a) == bits(b), "{what}: other positions");
    // Compared as text, because values that were not evaluated are NaN.
    assert_eq!(format!("{:?}", a.history), format!("{:?}", b.history), "{what}");
    let told = |o: &Outcome| (o.stop, o.sweeps, o.corrections, o.best_sweep, o.remaining, o.lost);
    assert_eq!(told(a), told(b), "{what}");
    let more = |o: &Outcome| {
        let on_cpu = (o.opening_sweeps, o.closing_sweeps);
        (on_cpu, o.alternated, o.levels_left_out, o.held_back, o.goal.clone())
    };
    assert_eq!(more(a), more(b), "{what}");
}

/// Continues a run from every `every`th checkpoint, and checks that each continuation ends with identical bits.
fn assert_goes_on(smoother: &Smoother<'_>, options: &Options, backend: &Backend, every: usize) {
    assert_goes_on_as("", smoother, options, backend, every);
}

/// Checks a run like [`assert_goes_on`]. `label` begins the message of a failure.
fn assert_goes_on_as(
    label: &str,
    smoother: &Smoother<'_>,
    options: &Options,
    backend: &Backend,
    every: usize,
) {
    let whole = smoother.run(options).on(backend).block().unwrap();
    let mut all = All::default();
    let kept = smoother.run(options).on(backend).checkpoints(&mut all).block().unwrap();
    let what = format!("{label} {} on the {}", options.scheme, name(backend));
    assert_same(&whole, &kept, &what);
    assert!(!all.0.is_empty(), "{what}: no checkpoint");
    for checkpoint in all.0.iter().step_by(every) {
        let what = format!("{what}, from sweep {}", checkpoint.sweeps());
        let mut none = All::default();
        let from = Some(checkpoint);
        let end =
            smoother.run(options).on(backend).resume(from).checkpoints(&mut none).block().unwrap();
        assert_same(&whole, &end, &what);
    }
}

#[test]
fn a_run_by_any_scheme_goes_on_to_the_same_bits() {
    let mesh = support::perturb_random(&plate(300), 1.0, 3);
    let smoother = Smoother::new(&mesh).unwrap();
    for backend in backends() {
        let every = if matches!(backend, Backend::Cpu) { 1 } else { 3 };
        for scheme in all_schemes().into_iter().step_by(every) {
            let alternates = scheme.alternates();
            let options = Options::default().scheme(scheme).max_sweeps(40);
            assert_goes_on(&smoother, &options, backend, 2);
            if alternates {
                let alone = options.method(Method::RELAXED);
                assert_goes_on(&smoother, &alone, backend, 2);
            }
        }
    }
}

/// Sweeps alone on this mesh go on after a measurement has refused an end, with another tolerance of the decay.
#[test]
fn sweeps_alone_that_go_on_after_a_refused_end_come_to_the_same_bits() {
    let mesh = support::perturb_random(&support::hub_evenly(200, 6), 0.5, 1);
    let smoother = Smoother::new(&mesh).unwrap();
    let options = Options::default().method(Method::RELAXED);
    for backend in backends() {
        assert_goes_on(&smoother, &options, backend, 4);
    }
}

/// Around a vertex of fifty, the levels change from the coordinates of the maps to those of the plane.
#[test]
fn a_run_whose_levels_change_coordinates_goes_on_to_the_same_bits() {
    let mesh = support::perturb_random(&support::hub(50, 1e-2), 1.0, 4);
    let topology = Topology::new(&mesh).unwrap();
    let targets = Targets::keep_shape(&topology, &mesh.points, 0).unwrap();
    let mut smoother = Smoother::new(&mesh).unwrap();
    smoother.set_targets(&targets).unwrap();
    for backend in backends() {
        let every = if matches!(backend, Backend::Cpu) { 2 } else { 6 };
        assert_goes_on(&smoother, &Options::default(), backend, every);
    }
}

/// Corrections of this bounded run on a device begin again after rounding has refused some.
#[test]
fn a_bounded_run_around_a_hub_goes_on_to_the_same_bits() {
    let mesh = support::perturb_random(&support::hub(50, 1e-2), 1.0, 3);
    let topology = Topology::new(&mesh).unwrap();
    let targets = Targets::keep_size(&topology, &mesh.points, Surface::Plane, 0).unwrap();
    let mut smoother = Smoother::new(&mesh).unwrap();
    smoother.set_targets(&targets).unwrap();
    let options = Options::default().scheme(Metric::Rms.into()).max_move(Some(3.0));
    assert_goes_on(&smoother, &options, &backends()[1], 3);
}

/// A checkpoint within a period contains the state of the stages at the beginning of the period.
#[test]
fn a_run_with_work_between_its_sweeps_goes_on_to_the_same_bits() {
    let mesh = support::perturb_random(&plate(300), 1.0, 3);
    let sizes: Vec<f64> = mesh.points.iter().map(|[x, _]| 1.0 + x * x).collect();
    let field = TargetField::new(&plate(300), &Targets::sizes(&sizes).unwrap()).unwrap();
    let default = Options::default;
    let limited = default().max_move(Some(0.2));
    let kept = default().keep_altitude(true);
    let worst = default().improve_worst(Some(WorstBy::Imr));
    let relaxed =
        default().method(Method::Relaxed(Relaxed::default())).scheme("imr+edge".parse().unwrap());
    for (name_of_case, options, slides, has_field) in [
        ("slide", default(), true, false),
        ("slide by sweeps alone", relaxed, true, false),
        ("max move", limited.clone(), false, false),
        ("slide and max move", limited, true, false),
        ("keep altitude", kept.clone(), false, false),
        ("slide and keep altitude", kept, true, false),
        ("field", default(), false, true),
        ("worst", worst, true, false),
    ] {
        let mut smoother = Smoother::new(&mesh).unwrap();
        let slide = slides.then(Slide::default);
        smoother.set_slide(slide.as_ref()).unwrap();
        if has_field {
            smoother.set_target_field(field.clone()).unwrap();
        }
        for backend in backends() {
            let options = options.clone().max_sweeps(20);
            let every = if matches!(backend, Backend::Cpu) { 1 } else { 4 };
            assert_goes_on_as(name_of_case, &smoother, &options, backend, every);
        }
    }
}

/// The hole of the plate is a curve, so Newton steps need the gradient at sliding vertices.
#[test]
fn a_run_by_newton_steps_of_sliding_vertices_goes_on_to_the_same_bits() {
    let mesh = support::perturb_random(&plate(404), 1.0, 3);
    let mut smoother = Smoother::new(&mesh).unwrap();
    smoother.set_slide(Some(&Slide::default())).unwrap();
    for backend in backends() {
        let options = Options::default().stopping(Stopping::Tolerance(1e-9)).max_sweeps(30);
        let steps = smoother.run(&options).on(backend).block().unwrap().newton_steps;
        assert!(steps > 1, "{steps} steps on the {}", name(backend));
        assert_goes_on(&smoother, &options, backend, 1);
    }
}

/// Checkpoints contain the local maps, which a change of the targets does not replace.
#[test]
fn a_run_with_a_target_field_on_a_strongly_stretched_mesh_goes_on_to_the_same_bits() {
    let lattice = support::perturb_random(&support::lattice(16, 16), 0.6, 4);
    let points: Vec<_> = lattice.points.iter().map(|&[x, y]| [200.0 * x, y]).collect();
    let mesh = with_points(&lattice, &points);
    let sizes: Vec<f64> = (0..points.len()).map(|v| 1.0 + (v % 3) as f64).collect();
    let field = TargetField::new(&mesh, &Targets::sizes(&sizes).unwrap()).unwrap();
    let mut smoother = Smoother::new(&mesh).unwrap();
    smoother.set_target_field(field).unwrap();
    for backend in backends() {
        let options = Options::default().scheme(Metric::SoftSize.into()).max_sweeps(20);
        assert_goes_on_as("stretched", &smoother, &options, backend, 1);
    }
}

/// Curves and target fields belong to a run, like the mesh.
#[test]
fn a_checkpoint_of_a_run_with_other_curves_or_another_field_is_refused() {
    let mesh = support::perturb_random(&plate(300), 1.0, 3);
    let mut smoother = Smoother::new(&mesh).unwrap();
    let options = Options::default().max_sweeps(9);
    let slide = |corner_angle| Slide { corner_angle, ..Slide::default() };
    smoother.set_slide(Some(&slide(40.0))).unwrap();
    let mut all = All::default();
    smoother.run(&options).checkpoints(&mut all).block().unwrap();
    let from = all.0.last();
    smoother.set_slide(Some(&slide(20.0))).unwrap();
    let error = smoother.run(&options).resume(from).block().unwrap_err();
    assert!(error.to_string().contains("curves or targets of the checkpoint differ"), "{error}");
    smoother.set_slide(None).unwrap();
    let error = smoother.run(&options).resume(from).block().unwrap_err();
    assert!(matches!(error, SmoothError::Checkpoint(_)), "{error}");
    smoother.set_slide(Some(&slide(40.0))).unwrap();
    smoother.run(&options).resume(from).block().unwrap();
}

/// A run that continues finds the start at means of neighbors again.
#[test]
fn a_run_that_begins_at_means_of_neighbors_goes_on_to_the_same_bits() {
    let mesh = pressed_to_a_line(bent(24, 20), 18.0, 1e-12);
    let smoother = Smoother::new(&mesh).unwrap();
    let options = Options::default().scheme(Metric::Tmop80.into());
    for backend in backends() {
        assert_goes_on_as("pressed", &smoother, &options, backend, 1);
    }
}

/// A hard mesh: on the CPU, opening sweeps prepare flat triangles for the device; secant pairs accelerate corrections;
/// and levels are fitted again.
#[test]
fn a_hard_run_goes_on_to_the_same_bits() {
    let lattice = support::perturb_random(&support::lattice(24, 24), 0.6, 4);
    let stretched = |ratio: f64| {
        let points: Vec<_> = lattice.points.iter().map(|&[x, y]| [ratio * x, y]).collect();
        with_points(&lattice, &points)
    };
    // The last two meshes have local maps.
    for (mesh, accelerated, has_targets) in [
        (perturbed().clone(), false, false),
        (stretched(40.0), true, false),
        (stretched(100.0), false, false),
        (stretched(100.0), false, true),
    ] {
        let mut smoother = Smoother::new(&mesh).unwrap();
        if has_targets {
            let sizes: Vec<f64> = mesh.points.iter().map(|[x, _]| 3000.0 + x).collect();
            smoother.set_targets(&Targets::sizes(&sizes).unwrap()).unwrap();
        }
        for backend in backends() {
            let options = Options::default();
            let mut all = All::default();
            let kept = smoother.run(&options).on(backend).checkpoints(&mut all).block().unwrap();
            let corrected = kept.corrections + kept.newton_steps;
            assert!(corrected > 1, "{corrected} corrections and Newton steps");
            // Secant pairs double the size of a checkpoint.
            let sizes: Vec<usize> = all.0.iter().map(|one| one.to_bytes().len()).collect();
            let per_vertex = sizes.iter().max().unwrap() / mesh.points.len();
            assert!(
                !accelerated || kept.corrections == 0 || per_vertex > 35,
                "{per_vertex} bytes a vertex: no pairs on the {}",
                name(backend)
            );
            assert_goes_on(&smoother, &options, backend, 2);
        }
    }
}

#[test]
fn a_resumed_run_does_not_seek_its_goal_again() {
    let mesh = support::perturb_random(&plate(300), 1.0, 3);
    let smoother = Smoother::new(&mesh).unwrap();
    let stopping = Stopping::Goal(Goal { fraction: 0.999, desired: None });
    let options = Options::default().stopping(stopping).method(Method::RELAXED);
    let mut all = All::default();
    let whole = smoother.run(&options).on(&Backend::Cpu).checkpoints(&mut all).block().unwrap();
    assert_eq!(whole.stop, Stop::Reached);
    let mut references = 0;
    let mut observe = |progress: &Progress| {
        references += usize::from(progress.phase == gpu_smooth::Phase::Reference);
        ControlFlow::Continue(())
    };
    let end = smoother
        .run(&options)
        .on(&Backend::Cpu)
        .resume(all.0.last())
        .checkpoints(&mut All::default())
        .observe(&mut observe)
        .block()
        .unwrap();
    assert_same(&whole, &end, "a goal");
    assert_eq!(references, 0);
}

#[test]
fn a_run_that_was_canceled_goes_on() {
    struct Last(Option<Checkpoint>);
    impl CheckpointPolicy for Last {
        fn wants_checkpoint(&mut self, is_ending: bool) -> bool {
            is_ending
        }
        fn checkpoint(&mut self, checkpoint: Checkpoint) {
            assert!(self.0.replace(checkpoint).is_none());
        }
    }
    let mesh = support::perturb_random(&plate(300), 1.0, 3);
    let smoother = Smoother::new(&mesh).unwrap();
    let options = Options::default();
    let whole = smoother.run(&options).on(&Backend::Cpu).block().unwrap();
    let mut last = Last(None);
    let cancel = |progress: &Progress| match progress.sweep {
        0..4 => ControlFlow::Continue(()),
        _ => ControlFlow::Break(()),
    };
    let left = smoother
        .run(&options)
        .on(&Backend::Cpu)
        .checkpoints(&mut last)
        .observe(cancel)
        .block()
        .unwrap();
    assert_eq!(left.stop, Stop::Canceled);
    let from = last.0.take();
    assert_eq!(from.as_ref().map(Checkpoint::sweeps), Some(left.sweeps));
    let end = smoother
        .run(&options)
        .on(&Backend::Cpu)
        .resume(from.as_ref())
        .checkpoints(&mut last)
        .block()
        .unwrap();
    assert_same(&whole, &end, "canceled");
}

/// A run canceled on a GPU can continue on the CPU. A run canceled on the CPU continues there with any backend.
#[test]
fn a_run_goes_on_on_the_cpu_wherever_it_was_left() {
    let mesh = support::perturb_random(&plate(300), 1.0, 3);
    let smoother = Smoother::new(&mesh).unwrap();
    let [cpu, gpu] = backends();
    for scheme in ["imr", "edge+imr"] {
        let options = Options::default().scheme(super::scheme(scheme));
        let on_cpu = smoother.run(&options).on(cpu).block().unwrap();
        let f = |o: &Outcome| {
            Quality::of(&o.points, smoother.topology()).unwrap().f(options.scheme.base())
        };
        for (left_on, goes_on_on) in [(gpu, cpu), (cpu, gpu)] {
            let mut all = All::default();
            smoother.run(&options).on(left_on).checkpoints(&mut all).block().unwrap();
            let from = &all.0[all.0.len() / 2];
            assert_eq!(from.adapter().is_some(), matches!(left_on, Backend::Gpu(_)));
            let mut all = All::default();
            let end = smoother
                .run(&options)
                .on(goes_on_on)
                .resume(from)
                .checkpoints(&mut all)
                .block()
                .unwrap();
            assert!(all.0.iter().all(|checkpoint| checkpoint.adapter().is_none()));
            assert!((f(&end) - f(&on_cpu)).abs() < 1e-3 * f(&on_cpu), "{scheme}");
        }
    }
}

#[test]
fn a_checkpoint_of_another_run_is_refused() {
    let mesh = support::perturb_random(&plate(300), 1.0, 3);
    let smoother = Smoother::new(&mesh).unwrap();
    let options = Options::default();
    let mut all = All::default();
    smoother.run(&options).on(&Backend::Cpu).checkpoints(&mut all).block().unwrap();
    let from = all.0.first();
    let refused = |smoother: &Smoother<'_>, options: &Options| {
        let mut none = All::default();
        let error = smoother
            .run(options)
            .on(&Backend::Cpu)
            .resume(from)
            .checkpoints(&mut none)
            .block()
            .unwrap_err();
        assert!(matches!(error, SmoothError::Checkpoint(_)), "{error:?}");
        error.to_string()
    };
    let other = options.clone().stopping(Stopping::Tolerance(1e-3));
    let error = refused(&smoother, &other);
    assert!(
        error.contains("tolerance 0.000001, and this run has stopping = tolerance 0.001"),
        "{error}"
    );
    let other = options.clone().scheme(Metric::Rms.into());
    refused(&smoother, &other);
    let mut held = mesh.clone();
    held.fixed.push(mesh.points.len() as u32 - 1);
    let error = refused(&Smoother::new(&held).unwrap(), &options);
    assert!(error.contains("mesh, held vertices"), "{error}");
}

/// Storing positions in memory, at any interval, does not change the result.
#[test]
fn keeping_positions_changes_no_bit() {
    struct Often;
    impl CheckpointPolicy for Often {
        fn interval(&self) -> Duration {
            Duration::ZERO
        }
    }
    let mesh = support::perturb_random(&plate(300), 1.0, 3);
    let smoother = Smoother::new(&mesh).unwrap();
    for backend in backends() {
        for scheme in ["imr", "edge+imr"] {
            let options = Options::default().scheme(super::scheme(scheme)).max_sweeps(40);
            let whole = smoother.run(&options).on(backend).block().unwrap();
            let kept = smoother.run(&options).on(backend).checkpoints(&mut Often).block().unwrap();
            assert_same(&whole, &kept, scheme);
        }
    }
}

/// The run opens flat triangles again, after sweeps that were undone once.
#[test]
fn a_run_by_edge_that_reopens_triangles_goes_on_to_the_same_bits() {
    for (seed, share) in [(87, 0.05), (5, 0.05)] {
        let start = stuck::untangled_square(seed, share);
        let smoother = Smoother::new(&start).unwrap();
        for backend in backends() {
            let options = Options::default().scheme(Metric::Edge.into());
            assert_goes_on(&smoother, &options, backend, 3);
        }
    }
}
