//! Final states of runs: known optima, or optima found by independent methods.

use crate::{backends, distorted, global, history, name, perturbed, run, with_points};
use gpu_smooth::{
    Method, Metric, Options, Quality, Smoother, Stop, Stopping, options::PNormExponent,
};

#[test]
fn a_perturbed_lattice_becomes_equilateral_again() {
    let lattice = support::lattice(20, 18);
    let mesh = support::perturb_random(&lattice, 1.0, 2);
    assert!(support::f_imr(&mesh) > 2.0);
    let smoother = Smoother::new(&mesh).unwrap();
    for &metric in Metric::ALL {
        for backend in backends() {
            let options =
                Options::default().scheme(metric.into()).stopping(Stopping::Tolerance(1e-9));
            let outcome = run(&smoother, &options, backend);
            let f = support::f_imr(&with_points(&mesh, &outcome.points));
            assert!(f - 1.0 < 1e-6, "{metric} on the {}: {:e}", name(backend), f - 1.0);
        }
    }
}

#[test]
fn rms_ends_at_the_solution_of_its_linear_system() {
    for mesh in [perturbed(), distorted()] {
        let optimum = global::rms_optimum(mesh);
        assert!(support::is_ccw(&optimum), "no guard has a say");
        let best = global::f_rms(&optimum);
        let smoother = Smoother::new(mesh).unwrap();
        for backend in backends() {
            let options = Options::default().scheme(Metric::Rms.into());
            let outcome = run(&smoother, &options, backend);
            let f = global::f_rms(&with_points(mesh, &outcome.points));
            assert!(f >= best * (1.0 - 1e-12), "the optimum is one");
            assert!(f / best - 1.0 < 1e-6, "on the {}: {:e}", name(backend), f / best - 1.0);
        }
    }
}

#[test]
fn imr_ends_at_the_optimum_of_a_global_method() {
    let (best, _) = global::imr_optimum(&global::rms_optimum(perturbed()));
    for mesh in [perturbed(), distorted()] {
        let smoother = Smoother::new(mesh).unwrap();
        for backend in backends() {
            let outcome = run(&smoother, &Options::default(), backend);
            let after = with_points(mesh, &outcome.points);
            let f = support::f_imr(&after);
            assert!(f / best - 1.0 < 1e-6, "on the {}: {:e}", name(backend), f / best - 1.0);
        }
        // A global descent from the final state finds no lower f.
        let outcome = run(&smoother, &Options::default(), &backends()[1]);
        let (further, _) = global::imr_optimum(&with_points(mesh, &outcome.points));
        assert!((further / best - 1.0).abs() < 1e-9, "{further} {best}");
    }
}

#[test]
fn edge_ends_at_the_best_known() {
    let mesh = perturbed();
    let smoother = Smoother::new(mesh).unwrap();
    let edge = |method, sharpness| {
        let options = Options::default().scheme(Metric::Edge.into());
        options.method(method).edge_norm(sharpness)
    };
    let imr = run(&smoother, &Options::default(), &backends()[0]);
    let from_imr = with_points(mesh, &imr.points);
    let after_imr = Smoother::new(&from_imr).unwrap();
    let f = |outcome: &gpu_smooth::Outcome| {
        history(outcome, Metric::Edge).into_iter().fold(f64::INFINITY, f64::min)
    };
    // The best of several hundred uncorrected sweeps. Thousands more would gain another 3e-5.
    let alone = |sharpness| edge(Method::RELAXED, Some(sharpness));
    let continued = alone(PNormExponent::CONTINUED).max_sweeps(700);
    let best = [&smoother, &after_imr].map(|s| f(&run(s, &continued, &backends()[0])));
    let best = best[0].min(best[1]);
    for backend in backends() {
        let place = name(backend);
        let corrected = run(&smoother, &edge(Method::Auto, None), backend);
        let end = f(&corrected);
        // The last exponent is sixteen times that of uncorrected sweeps.
        assert!(end / best - 1.0 < -1.5e-4, "{end} for {best} on the {place}");
        assert!(corrected.corrections > 30 && corrected.sweeps < 160, "{}", corrected.sweeps);
        // The returned state is the best of all sweeps.
        let returned = Quality::of(&corrected.points, smoother.topology()).unwrap().f(Metric::Edge);
        assert!((returned / end - 1.0).abs() < 1e-6, "{returned} for {end} on the {place}");
        let fixed = f(&run(&smoother, &alone(PNormExponent::FIXED), backend));
        assert!(fixed / best - 1.0 < 1e-2, "{fixed} for {best} on the {place}");
    }
}

/// The meshes of `meshes/`, each with the smallest known f by EDGE. The values come from twelve runs per mesh on the
/// CPU, with four initial exponents and three rates of doubling, up to the exponent 32768 and 600 sweeps.
const BEST_BY_EDGE: [(&str, f64); 7] = [
    ("airplane", 1.497562),
    ("duck", 1.478602),
    ("fish", 1.477150),
    ("hand", 1.531380),
    ("mechanic", 1.557203),
    ("plate", 1.462708),
    ("twoholes", 1.505479),
];

#[test]
fn edge_ends_within_1e_4_of_the_best_known_after_some_eighty_sweeps() {
    for (mesh, best) in BEST_BY_EDGE {
        let read = support::read_mesh(&support::meshes().join(mesh).with_extension("node"));
        let smoother = Smoother::new(&read).unwrap();
        let worst =
            |points: &[[f64; 2]]| Quality::of(points, smoother.topology()).unwrap().worst_imr;
        let before = worst(&read.points);
        for backend in backends() {
            let on = format!("{mesh} on the {}", name(backend));
            let ends = |tolerance| {
                let edge = Options::default()
                    .scheme(Metric::Edge.into())
                    .stopping(Stopping::Tolerance(tolerance));
                let outcome = run(&smoother, &edge, backend);
                assert_eq!(outcome.stop, Stop::Converged, "{on}");
                assert!(worst(&outcome.points) <= before, "{on}: the shape guard holds");
                let f = Quality::of(&outcome.points, smoother.topology()).unwrap().f(Metric::Edge);
                (outcome, f / best - 1.0)
            };
            let (outcome, above) = ends(1e-6);
            assert!(above < 1e-4 && above > -5e-5, "{on}: {above:e}");
            assert!(outcome.sweeps <= 140, "{on}: {}", outcome.sweeps);
            // `remaining` includes the effect of the last exponent.
            let told = outcome.remaining.unwrap();
            assert!(told > 1.9e-5 && told < 1e-4, "{on}: {told:e}");
            // With a coarser tolerance, runs end sooner, at a smaller exponent.
            let (outcome, above) = ends(1e-3);
            assert!(above < 1e-3 && above > 1e-4, "{on}: {above:e}");
            assert!(outcome.sweeps <= 50, "{on}: {}", outcome.sweeps);
        }
    }
}
