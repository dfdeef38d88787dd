//! The guard of the worst element, `--guard worst`, on both engines.

use crate::worst::FIVE_DIGITS;
use crate::{backends, history, name, plate, run, with_points};
use gpu_smooth::{Backend, Guard, Metric, Options, Slide, Smoother, Stop};
use support::check;

/// On a mesh graded to a point and slightly perturbed, metrics of size would trade bad shapes for even
/// sizes.
#[test]
fn the_worst_element_does_not_get_worse_by_any_metric() {
    let mesh = support::perturb_random(&support::graded(12, 0.1), 0.2, 4);
    let smoother = Smoother::new(&mesh).unwrap();
    let worst = |points: &[[f64; 2]]| {
        let movable = |t: &[u32; 3]| t.iter().any(|&v| smoother.topology().free()[v as usize]);
        let all = smoother.topology().triangles().iter().filter(|t| movable(t));
        let ratio = |t: &[u32; 3]| check::imr(t.map(|v| points[v as usize]));
        all.map(ratio).fold(1.0, f64::max)
    };
    let before = worst(&mesh.points);
    let mut risen = 0;
    for metric in [Metric::ShapeSize, Metric::Imr, Metric::Rms] {
        for guard in [Guard::ByMetric, Guard::Worst] {
            let options = Options::default().scheme(metric.into()).guard(guard);
            for backend in backends() {
                let outcome = run(&smoother, &options, backend);
                let after = worst(&outcome.points);
                let label = format!("{metric} on the {}: {before} {after}", name(backend));
                let f = history(&outcome, metric);
                assert!(f[f.len() - 1] < f[0], "{label}");
                if guard == Guard::Worst {
                    assert!(after <= before, "{label}");
                    assert_eq!(outcome.stop, Stop::Converged, "{label}");
                } else if after > 1.01 * before {
                    risen += 1;
                }
                assert!(check::is_valid(&with_points(&mesh, &outcome.points)), "{label}");
            }
        }
    }
    // Without the guard, the worst element becomes worse.
    assert!(risen >= 2, "{risen}");
}

/// Rounding to the digits of the file made triangles at the guard worse.
#[test]
fn the_guard_holds_for_points_as_they_are_stored() {
    let mut judged = 0;
    for seed in 0..40 {
        let mut mesh = support::perturb_random(&support::graded(12, 0.1), 0.2, seed);
        for x in mesh.points.as_flattened_mut() {
            *x = FIVE_DIGITS.rounded(*x + 20.0);
        }
        if !check::is_ccw(&mesh) {
            continue;
        }
        judged += 1;
        let smoother = Smoother::new(&mesh).unwrap();
        let options = Options::default().scheme(Metric::ShapeSize.into());
        let options = options.stored(FIVE_DIGITS).guard(Guard::Worst);
        let points = run(&smoother, &options, &Backend::Cpu).points;
        let [before, after] =
            [&mesh.points, &points].map(|points| support::worst_imr(&with_points(&mesh, points)));
        assert!(after <= before * (1.0 + 1e-9), "seed {seed}: {before} {after}");
    }
    assert!(judged > 5, "{judged}");
}

/// The first sweeps of a run with sliding leave a better worst triangle than the given mesh has. By equal areas, later sweeps
/// lower f with a worse triangle again, which the guard of the given mesh allows.
#[test]
fn the_guard_of_a_run_with_sliding_is_that_of_the_given_mesh() {
    let mesh = support::perturb_random(&plate(500), 0.6, 5);
    let mut smoother = Smoother::new(&mesh).unwrap();
    smoother.set_slide(Some(&Slide::default())).unwrap();
    let worst = |points: &[[f64; 2]]| support::worst_imr(&with_points(&mesh, points));
    for backend in backends() {
        let [first, last] = [2, 12].map(|max_sweeps| {
            let options = Options::default().scheme(Metric::Area.into()).max_sweeps(max_sweeps);
            worst(&run(&smoother, &options, backend).points)
        });
        let (given, label) = (worst(&mesh.points), name(backend));
        assert!(first < 0.9 * given && last > 1.2 * first, "{label}: {given} {first} {last}");
        assert!(last <= given, "{label}: {given} {last}");
    }
}
