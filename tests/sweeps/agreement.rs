//! Both engines execute equal sweeps, in any grouping.

use crate::{backends, engine, is_of_angles, name, perturbed, plan, plate, problem, scheme};
use gpu_smooth::{
    Backend, Metric, Quality, Stop, Topology,
    internal::{Plan, Problem, Stepwise, StopRule, run_on_cpu, run_on_gpu},
    options::{Derivatives, PNormExponent},
};
use support::quadrilaterals;

/// Objectives after one sweep, and the largest distance of a vertex between CPU and GPU, relative to the distance it
/// moved.
struct OneSweep {
    f: [f64; 2],
    moved_apart: f64,
}

fn one_sweep(problem: &Problem, plans: [Plan; 2]) -> OneSweep {
    let base = plans[0].scheme.base();
    let mut f = [0.0; 2];
    let mut positions = Vec::new();
    for (i, (backend, plan)) in backends().iter().zip(plans).enumerate() {
        let mut engine = engine(backend, problem, plan);
        f[i] = engine.advance(1).unwrap()[1].of(base).unwrap();
        positions.push(engine.best_positions().unwrap());
    }
    let moves = problem.positions().iter().zip(&positions[0]).zip(&positions[1]);
    let apart = moves.map(|((was, cpu), gpu)| {
        // Edges are approximately 1.5 long. Moves below a thousandth count as a thousandth.
        cpu.distance(*gpu) / was.distance(*cpu).max(1e-3)
    });
    OneSweep { f, moved_apart: apart.fold(0.0, f64::max) }
}

fn mild() -> Problem {
    problem(&support::perturb_random(&plate(2000), 0.5, 3))
}

#[test]
fn one_sweep_is_the_same_on_both_engines() {
    let problem = mild();
    for &metric in Metric::ALL {
        for unrelaxed_sweeps in [0, 4] {
            let plan = Plan { unrelaxed_sweeps, ..plan(metric.into(), 1) };
            let OneSweep { f: [cpu, gpu], moved_apart } = one_sweep(&problem, [plan.clone(), plan]);
            // In single precision, a step is accurate to 1e-6 of its length; bad shapes and the p-norm of EDGE amplify
            // the error, and so do penalties on angles. f is a mean, in which most of the error cancels.
            let [of_f, of_moves] = if is_of_angles(metric) { [2e-5, 0.1] } else { [1e-6, 1e-3] };
            assert!((gpu / cpu - 1.0).abs() < of_f, "{metric}: {gpu} for {cpu}");
            assert!(moved_apart < of_moves, "{metric}: {moved_apart:e}");
        }
    }
}

#[test]
fn one_sweep_of_quadrilaterals_is_the_same_on_both_engines() {
    for mesh in [quadrilaterals::squares(24), quadrilaterals::mixed(24)] {
        let problem = problem(&quadrilaterals::perturbed(&mesh, 0.2));
        for &metric in Metric::ALL {
            // Differences lose the digits of penalties on angles in single precision.
            let all = [Derivatives::Analytic, Derivatives::FiniteDifference];
            let count = if is_of_angles(metric) { 1 } else { 2 };
            for derivatives in &all[..count] {
                let derivatives = [*derivatives; Metric::ALL.len()];
                let plan = Plan { derivatives, track_all: true, ..plan(metric.into(), 1) };
                let found = one_sweep(&problem, [plan.clone(), plan]);
                let OneSweep { f: [cpu, gpu], moved_apart } = found;
                // Differences over a short way lose digits in single precision.
                let [of_f, of_moves] = match (is_of_angles(metric), derivatives[0]) {
                    (true, _) => [2e-4, 0.2],
                    (_, Derivatives::FiniteDifference) => [5e-3, 0.3],
                    _ => [1e-6, 1e-3],
                };
                let kind = (metric, derivatives[0]);
                assert!((gpu / cpu - 1.0).abs() < of_f, "{kind:?}: {gpu} for {cpu}");
                assert!(moved_apart < of_moves, "{kind:?}: {moved_apart:e}");
            }
        }
    }
}

#[test]
fn a_penalty_keeps_edge_off_the_shape_guard_on_both_engines_alike() {
    let problem = mild();
    let mesh = support::perturb_random(&plate(2000), 0.5, 3);
    let before = Quality::of(&mesh.points, &Topology::new(&mesh).unwrap()).unwrap().worst_imr;
    for (share, k) in [(0.5, 1), (0.3, 4), (0.7, 4), (0.3, 7)] {
        let sharpness = PNormExponent { first: k, every: 0, last: k };
        let shape_guard = 1.0 + share * (before - 1.0);
        let both = |is_guard_penalized| {
            let plan = plan(Metric::Edge.into(), 1);
            let plan = Plan { sharpness, shape_guard, is_guard_penalized, ..plan };
            one_sweep(&problem, [plan.clone(), plan])
        };
        let OneSweep { f: [cpu, gpu], moved_apart } = both(true);
        // The agreement is as good as without the penalty, and the penalty has an effect.
        assert!((gpu / cpu - 1.0).abs() < 1e-6, "{k}: {gpu} for {cpu}");
        assert!(moved_apart < 2e-2, "{k}: {moved_apart:e}");
        let without = both(false).f[0];
        assert!((without / cpu - 1.0).abs() > 5e-4, "{k}: {without} for {cpu}");
    }
}

#[test]
fn every_sweep_of_a_run_is_the_same_on_both_engines() {
    let problem = mild();
    let sharpness = PNormExponent { first: 1, every: 3, last: 4 };
    let own = |name: &str| Plan { sharpness, unrelaxed_sweeps: 3, ..plan(scheme(name), 12) };
    let twice = Plan { newton_steps: 2, ..own("imr") };
    let settled = Plan { newton_steps: 50, ..own("imr") };
    for plan in [own("imr"), own("rms"), own("edge"), own("edge+imr+imr"), twice, settled] {
        let [cpu, gpu] = backends().each_ref().map(|backend| {
            let log = engine(backend, &problem, plan.clone()).advance(12).unwrap();
            log.iter().map(|o| o.of(plan.scheme.base()).unwrap()).collect::<Vec<_>>()
        });
        assert_eq!((cpu.len(), gpu.len()), (13, 13));
        for (sweep, (cpu, gpu)) in cpu.iter().zip(gpu).enumerate() {
            // One sweep agrees to 1e-7 of f. A wrong metric, relaxation or exponent would cause a difference of 1e-4.
            let scheme = &plan.scheme;
            assert!((gpu / cpu - 1.0).abs() < 1e-5, "{scheme}, sweep {sweep}: {gpu} for {cpu}");
        }
    }
}

#[test]
fn a_visit_ends_once_its_steps_are_short() {
    let problem = mild();
    let after = |inner| {
        let mut engine = run_on_cpu(
            &problem,
            problem.positions(),
            Plan { newton_steps: inner, ..plan(Metric::Imr.into(), 1) },
        );
        engine.advance(1).unwrap();
        engine.best_positions().unwrap()
    };
    assert_ne!(after(2), after(30));
    assert_eq!(after(30), after(1000));
}

#[test]
fn each_metric_of_a_scheme_is_differentiated_in_its_own_way() {
    let problem = mild();
    let mut edge_only = [Derivatives::Analytic; Metric::ALL.len()];
    edge_only[Metric::Edge as usize] = Derivatives::FiniteDifference;
    for backend in backends() {
        let f = |name: &str, derivatives| {
            let plan = Plan { derivatives, ..plan(scheme(name), 2) };
            let base = plan.scheme.base();
            let log = engine(backend, &problem, plan).advance(2).unwrap();
            log.iter().map(|o| o.of(base).unwrap()).collect::<Vec<_>>()
        };
        let [exact, edges, all] = [
            [Derivatives::Analytic; Metric::ALL.len()],
            edge_only,
            [Derivatives::FiniteDifference; Metric::ALL.len()],
        ]
        .map(|derivatives| f("imr+edge", derivatives));
        assert_eq!(edges[1], exact[1], "imr exactly");
        assert_ne!(edges[2], exact[2], "edge by differences");
        assert_ne!(all[1], exact[1]);
    }
}

#[test]
fn the_comparison_of_sweeps_fails_for_a_slightly_different_sweep() {
    let problem = mild();
    for &metric in Metric::ALL {
        let plan =
            Plan { unrelaxed_sweeps: 0, omega: [1.0; Metric::ALL.len()], ..plan(metric.into(), 1) };
        let longer = Plan { omega: [1.05; Metric::ALL.len()], ..plan.clone() };
        let OneSweep { f: [cpu, gpu], moved_apart } = one_sweep(&problem, [plan, longer]);
        assert!((gpu / cpu - 1.0).abs() > 1e-5 && moved_apart > 1e-2, "{metric}: {moved_apart:e}");
    }
}

#[test]
fn runs_are_identical_whatever_the_batch() {
    let problem = problem(perturbed());
    for name_of_scheme in ["imr", "edge", "edge+imr+imr", "area+imr"] {
        for backend in backends() {
            let stop = StopRule { goal: None, tolerance: 1e-4, max_sweeps: 90 };
            let plan = Plan { stop, ..plan(scheme(name_of_scheme), 0) };
            let mut runs = Vec::new();
            // The batch size 50 is tried twice, because results must be reproducible.
            for batch in [1, 3, 50, 300, 50] {
                let mut engine = engine(backend, &problem, plan.clone());
                let mut log = Vec::new();
                while engine.stop().is_none() {
                    let more = engine.advance(batch).unwrap();
                    assert!(!more.is_empty(), "a run that goes on must get somewhere");
                    log.extend(more);
                }
                assert!(engine.advance(5).unwrap().is_empty(), "nothing happens after the end");
                let f: Vec<u64> =
                    log.iter().map(|o| o.of(plan.scheme.base()).unwrap().to_bits()).collect();
                let bits: Vec<_> = engine
                    .best_positions()
                    .unwrap()
                    .iter()
                    .map(|p| p.to_array().map(f64::to_bits))
                    .collect();
                runs.push((engine.stop(), f, bits));
            }
            let sweeps = runs[0].1.len() - 1;
            assert!(sweeps > 16 && sweeps <= 90, "{name_of_scheme}: {sweeps} sweeps");
            let same = runs.iter().all(|run| *run == runs[0]);
            assert!(same, "{name_of_scheme} on the {}", name(backend));
        }
    }
}

#[test]
fn a_target_ends_a_run_at_the_first_sweep_below_it() {
    let problem = problem(perturbed());
    for backend in backends() {
        let mut whole = engine(backend, &problem, plan(scheme("imr"), 20));
        let f: Vec<f64> =
            whole.advance(20).unwrap().iter().map(|o| o.of(Metric::Imr).unwrap()).collect();
        assert_eq!(whole.stop(), Some(Stop::MaxSweeps));
        for sweep in [1, 2, 7, 13] {
            let goal = Some(0.5 * (f[sweep] + f[sweep - 1]));
            let stop = StopRule { goal, tolerance: 0.0, max_sweeps: 20 };
            let mut engine = engine(backend, &problem, Plan { stop, ..plan(scheme("imr"), 0) });
            assert_eq!(engine.advance(20).unwrap().len() - 1, sweep, "on the {}", name(backend));
            assert_eq!(engine.stop(), Some(Stop::Reached));
        }
    }
}

/// The stop rule exists twice: in Rust, and in `shaders/finish.wgsl` for batches that end on the device.
#[test]
fn the_device_ends_a_run_where_the_rule_in_rust_does() {
    let problem = problem(perturbed());
    let Backend::Gpu(gpu) = &backends()[1] else { panic!("the second backend is the GPU") };
    let rule = |goal, tolerance, max_sweeps| StopRule { goal, tolerance, max_sweeps };
    let cases = [
        ("imr", rule(Some(1.2), 0.0, 90), Stop::Reached),
        ("imr", rule(Some(1.0), 0.0, 90), Stop::Stalled),
        ("imr", rule(None, 1e-4, 90), Stop::Converged),
        ("rms", rule(None, 1e-6, 90), Stop::Converged),
        ("area+imr", rule(None, 1e-6, 90), Stop::Stalled),
        ("edge+imr+imr", rule(None, 1e-2, 90), Stop::Converged),
        ("edge", rule(None, 0.0, 40), Stop::MaxSweeps),
    ];
    for (name, stop, expected) in cases {
        let plan = Plan { stop, ..plan(scheme(name), 0) };
        let base = plan.scheme.base();
        let window = StopRule::window(&plan.scheme) as usize;
        let mut run = run_on_gpu(gpu, &problem, problem.positions(), plan).unwrap();
        let log = run.advance(100).unwrap();
        assert_eq!(run.stop(), Some(expected), "{name}, {stop:?}");
        let f: Vec<f64> = log.iter().map(|o| o.of(base).unwrap()).collect();
        for end in 1..=f.len() {
            let best = (0..end).min_by(|&a, &b| f[a].total_cmp(&f[b])).unwrap();
            let judged = stop.judge(&f[..end], best, window);
            let on_device = (end == f.len()).then_some(expected);
            assert_eq!(judged, on_device, "{name}, {stop:?}, after {} sweeps", end - 1);
        }
    }
}
