//! Bounds on moves and on altitudes together with options under which single sweeps may raise f, and with each other.

use crate::altitude::fields;
use crate::{backends, history, name, plate, run, with_free_layers};
use gpu_smooth::{
    Goal, Mesh, Method, Metric, Options, Outcome, Smoother, Stop, Stopping, measure::Change,
    topology,
};

const MOST: f64 = 0.15;

/// Two meshes with the bounds of their runs. Without the bound, vertices of the first mesh move by more than [`MOST`], and
/// the least altitude of the second mesh falls.
fn cases() -> [(Mesh, Options); 3] {
    let moved = Options::default().max_move(Some(MOST));
    let kept = Options::default().keep_altitude(true);
    let both = kept.clone().max_move(Some(1.0));
    let plate = support::perturb_random(&plate(300), 0.5, 3);
    [(plate, moved), (fields(12), kept), (fields(12), both)]
}

/// Asserts that a run has kept its bounds, and has moved at least one vertex or triangle to its bound.
fn assert_bounded(label: &str, smoother: &Smoother, options: &Options, outcome: &Outcome) {
    let (before, after) = (&smoother.mesh().points, &outcome.points);
    let change = Change::between(smoother.topology(), before, after).unwrap();
    if let Some(most) = options.max_move {
        assert!(change.moved.most <= most, "{label}: {:?}", change.moved);
        assert!(change.moved.most > 0.99 * most, "{label}: {:?}", change.moved);
    }
    if options.keep_altitude {
        let [before, after] = change.least_altitude;
        assert!(after >= before, "{label}: {before} {after}");
    }
    let bad = topology::infeasible(after, smoother.topology().triangles()).unwrap();
    assert!(bad.is_empty(), "{label}");
}

/// Returns the share of the gain in f by imr of a bounded run by imr alone that another bounded run has.
fn share(smoother: &Smoother, points: &[[f64; 2]], bounded: &Options) -> f64 {
    let f = |points: &[[f64; 2]]| smoother.f(Metric::Imr, points).unwrap();
    let by_imr = run(smoother, bounded, &backends()[0]);
    let start = f(&smoother.mesh().points);
    (start - f(points)) / (start - f(&by_imr.points))
}

#[test]
fn alternating_schemes_and_edge_keep_bounds_on_both_engines() {
    for (mesh, bounded) in cases() {
        let smoother = with_free_layers(&mesh);
        for (scheme, least) in [("imr+edge", 0.8), ("imr+area", 0.8), ("edge", 0.005)] {
            for method in [Method::Auto, Method::RELAXED] {
                let options = bounded.clone().scheme(scheme.parse().unwrap()).method(method);
                for backend in backends() {
                    let label = format!(
                        "{scheme}, {method:?}, {:?} on the {}",
                        options.max_move,
                        name(backend)
                    );
                    let outcome = run(&smoother, &options, backend);
                    assert!(outcome.sweeps > 1, "{label}");
                    assert_bounded(&label, &smoother, &options, &outcome);
                    let share = match options.scheme.base() {
                        Metric::Imr => share(&smoother, &outcome.points, &bounded),
                        edge => {
                            let f = |points| smoother.f(edge, points).unwrap();
                            let [start, end] = [&mesh.points, &outcome.points].map(|at| f(at));
                            (start - end) / start
                        }
                    };
                    assert!(share > least, "{label}: {share}");
                }
            }
        }
    }
}

/// The desired f is the limit of f within the bound, so a run of a fraction of 1 comes near its bound.
#[test]
fn a_searched_goal_is_the_optimum_within_the_bounds() {
    for (mesh, bounded) in cases() {
        let smoother = with_free_layers(&mesh);
        let end = *history(&run(&smoother, &bounded, &backends()[0]), Metric::Imr).last().unwrap();
        let free = *history(&run(&smoother, &Options::default(), &backends()[0]), Metric::Imr)
            .last()
            .unwrap();
        for backend in backends() {
            let stopping = Stopping::Goal(Goal { fraction: 0.99, desired: None });
            let outcome = run(&smoother, &bounded.clone().stopping(stopping), backend);
            let label = format!("{:?} on the {}", bounded.max_move, name(backend));
            assert_eq!(outcome.stop, Stop::Reached, "{label}");
            let desired = outcome.goal.unwrap().desired;
            assert!((desired / end - 1.0).abs() < 1e-4, "{label}: {desired} {end}");
            assert!(desired > 1.005 * free, "{label}: {desired} {free}");
            let change =
                Change::between(smoother.topology(), &mesh.points, &outcome.points).unwrap();
            assert!(change.moved.most <= bounded.max_move.unwrap_or(f64::INFINITY), "{label}");
        }
    }
}

/// Finite differences have errors, and a projected step is no Newton step.
#[test]
fn sweeps_by_finite_differences_keep_bounds() {
    for (mesh, bounded) in cases() {
        let smoother = with_free_layers(&mesh);
        let paper = Options::paper(Metric::Imr.into());
        let Options { max_move, keep_altitude, .. } = bounded;
        let options = paper.max_move(max_move).keep_altitude(keep_altitude);
        let outcome = run(&smoother, &options, &backends()[0]);
        assert_bounded("finite differences", &smoother, &options, &outcome);
        let share = share(&smoother, &outcome.points, &bounded);
        assert!(share > 0.99, "{share} of the gain by imr alone");
    }
}
