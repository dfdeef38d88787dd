//! Valid settings of options, and the errors for invalid ones.

use crate::{backends, history, perturbed, plate, run, scheme, with_points};
use gpu_smooth::{
    Backend, Goal, Gpu, GpuError, Method, Metric, OptionError, Options, Phase, Quality, Scheme,
    SmoothError, Smoother, Stop, Stopping,
    options::{PNormExponent, Paper, Relaxed},
};
use std::ops::ControlFlow;

#[test]
fn an_observer_can_end_a_run_and_gets_the_best_so_far() {
    let mesh = perturbed();
    let smoother = Smoother::new(mesh).unwrap();
    for backend in backends() {
        for name in ["imr", "edge+imr"] {
            let options =
                Options::default().scheme(scheme(name)).stopping(Stopping::Tolerance(0.0));
            let base = options.scheme.base();
            let mut seen = Vec::new();
            let mut observe = |progress: &gpu_smooth::Progress| {
                assert_eq!(progress.phase, Phase::Smoothing);
                seen.push((progress.sweep, progress.f));
                if seen.len() == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            let outcome = smoother.run(&options).on(backend).observe(&mut observe).block().unwrap();
            assert_eq!(outcome.stop, Stop::Canceled);
            let [(first, _), (last, f)] = seen[..] else { panic!("asked {} times", seen.len()) };
            assert!(first < last && last == outcome.sweeps && last < options.max_sweeps);
            let history = history(&outcome, base);
            assert_eq!(history.len() as u32, outcome.sweeps + 1);
            assert_eq!(history.last(), Some(&f));
            let best = history.iter().copied().fold(f64::INFINITY, f64::min);
            let after = with_points(mesh, &outcome.points);
            // A device evaluates f in single precision. After the first sweeps, flat triangles remain, whose areas have
            // fewer digits. The number of completed sweeps depends on the machine.
            let near = match (backend, outcome.sweeps) {
                (Backend::Cpu, _) => 1e-9,
                (Backend::Gpu(_), 0..4) => 2e-6,
                (Backend::Gpu(_), _) => 1e-8,
            };
            assert!(
                (Quality::of(&after.points, smoother.topology()).unwrap().f(base) / best - 1.0)
                    .abs()
                    < near
            );
            assert!(support::is_ccw(&after));
        }
    }
}

#[test]
fn a_run_canceled_while_the_optimum_is_sought_returns_the_start() {
    // A former defect: the best f so far was taken for the optimum, and the run ended as reached.
    let mesh = perturbed();
    let smoother = Smoother::new(mesh).unwrap();
    let stopping = Stopping::Goal(Goal { fraction: 0.95, desired: None });
    for backend in backends() {
        for name in ["imr", "edge"] {
            let options = Options::default().scheme(scheme(name)).stopping(stopping);
            let cancel = &mut |progress: &gpu_smooth::Progress| {
                assert_eq!(progress.phase, Phase::Reference);
                ControlFlow::Break(())
            };
            let outcome = smoother.run(&options).on(backend).observe(cancel).block().unwrap();
            assert_eq!((outcome.stop, outcome.sweeps), (Stop::Canceled, 0));
            assert!(outcome.points == mesh.points && outcome.goal.is_none());
        }
    }
}

#[test]
fn options_out_of_range_are_named() {
    let mesh = plate(300);
    let smoother = Smoother::new(&mesh).unwrap();
    let default = Options::default;
    let goal = |fraction, desired| Stopping::Goal(Goal { fraction, desired: Some(desired) });
    let omega = |omega| Method::Relaxed(Relaxed { omega: Some(omega), ..Relaxed::default() });
    let steps = |newton_steps| Method::Paper(Paper { newton_steps, ..Paper::default() });
    let sharpness = |first, last| Some(PNormExponent { first, every: 1, last });
    let long = Scheme::new(vec![Metric::Imr; 61]).unwrap();
    let wrong = [
        ("tolerance", default().stopping(Stopping::Tolerance(-1e-9))),
        ("tolerance", default().stopping(Stopping::Tolerance(f64::NAN))),
        ("tolerance", default().stopping(Stopping::Tolerance(f64::INFINITY))),
        ("omega", default().method(omega(0.0))),
        ("omega", default().method(omega(2.0))),
        ("omega", default().method(omega(f64::NAN))),
        ("newton steps", default().method(steps(0))),
        // A sweep with more Newton steps could not be canceled in time.
        ("newton steps", default().method(steps(Paper::MAX_NEWTON_STEPS + 1))),
        ("edge norm", default().edge_norm(sharpness(14, 4))),
        ("edge norm", default().edge_norm(sharpness(1, 14))),
        // A former defect: no sweep of the run was encoded on a device, and the run ended as converged.
        ("edge norm", default().edge_norm(Some(PNormExponent { first: 5, every: 0, last: 2 }))),
        ("scheme length", default().scheme(long)),
        ("fraction", default().stopping(goal(0.0, 1.0))),
        ("fraction", default().stopping(goal(1.5, 1.0))),
        ("fraction", default().stopping(goal(f64::NAN, 1.0))),
        ("desired", default().stopping(goal(0.95, f64::NAN))),
    ];
    for (named, options) in wrong {
        for backend in backends() {
            let error = smoother.run(&options).on(backend).block();
            match error {
                Err(SmoothError::Option(OptionError::OutOfRange { option, .. })) => {
                    assert_eq!(option, named)
                }
                other => panic!("{named}: {:?}", other.map(|outcome| outcome.stop)),
            }
        }
    }
    // The ends of the ranges are valid.
    let edge = default()
        .method(omega(1.99))
        .edge_norm(sharpness(0, 10))
        .scheme(Scheme::new(vec![Metric::Edge; 60]).unwrap())
        .stopping(goal(1.0, 0.0))
        .max_sweeps(3);
    assert_eq!(run(&smoother, &edge, &backends()[0]).stop, Stop::MaxSweeps);
}

#[test]
fn no_sweep_at_all_leaves_the_mesh_as_it_is() {
    let mesh = support::perturb_random(&plate(300), 1.0, 1);
    let smoother = Smoother::new(&mesh).unwrap();
    for backend in backends() {
        for name in ["imr", "edge+imr"] {
            let options = Options::default().scheme(scheme(name)).max_sweeps(0);
            let outcome = run(&smoother, &options, backend);
            assert_eq!((outcome.stop, outcome.sweeps, outcome.best_sweep), (Stop::MaxSweeps, 0, 0));
            assert_eq!(outcome.points, mesh.points);
            let f =
                Quality::of(&mesh.points, smoother.topology()).unwrap().f(options.scheme.base());
            assert!((history(&outcome, options.scheme.base())[0] / f - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn every_metric_is_tracked_on_request() {
    let mesh = perturbed();
    let smoother = Smoother::new(mesh).unwrap();
    let options = Options::default().scheme(scheme("rms+imr")).track_all(true).max_sweeps(6);
    let outcomes = backends().each_ref().map(|backend| run(&smoother, &options, backend));
    for sweep in 0..=6 {
        for &metric in Metric::ALL {
            let [cpu, gpu] = outcomes.each_ref().map(|o| o.history[sweep].of(metric).unwrap());
            // In single precision, triangles a thousand times longer than high cause errors of this size.
            // Once sweeps gain little, the CPU takes Newton steps of all vertices, and the device corrections.
            let most = if sweep < 5 { 1e-4 } else { 3e-2 };
            assert!((gpu / cpu - 1.0).abs() < most, "{metric}, sweep {sweep}: {gpu} for {cpu}");
        }
    }
    let alone = run(&smoother, &options.track_all(false), &backends()[1]);
    assert_eq!(alone.points, outcomes[1].points, "looking changes nothing");
    assert_eq!(alone.history[3].of(Metric::Imr), None);
}

#[test]
fn an_unknown_adapter_is_an_error_that_lists_those_there_are() {
    let Backend::Gpu(gpu) = &backends()[1] else { panic!("the second backend is the GPU") };
    let there = &gpu.adapter().name;
    let error = Gpu::open(Some("no such adapter")).block().expect_err("there is none of that name");
    assert!(matches!(error, GpuError::NoAdapter { .. }));
    let text = error.to_string();
    assert!(text.contains("'no such adapter'") && text.contains(there.as_str()), "{text}");
    // A part of the name suffices, in upper or lower case.
    let part = there[..there.len() / 2].to_uppercase();
    assert!(Gpu::open(Some(&part)).block().is_ok(), "{part}");
}
