//! `max_move`, a bound on the distances that vertices move, on both engines.

use std::collections::BTreeSet;

use crate::{backends, history, name, plate, run, with_points};
use gpu_smooth::{
    Backend, Mesh, Method, Metric, OptionError, Options, Slide, SmoothError, Smoother, Stop,
    Stopping, Targets, measure::Change, options::Precision,
};
use support::check;

#[test]
fn no_vertex_goes_beyond_its_bound_and_f_is_as_low_as_that_allows() {
    let mesh = support::perturb_random(&plate(300), 0.5, 3);
    let smoother = Smoother::new(&mesh).unwrap();
    let topology = smoother.topology();
    let mut least = f64::INFINITY;
    for most in [0.05, 0.3, 2.0] {
        let max_move = Some(most);
        let options = Options::default().max_move(max_move).stored(Precision::Single);
        let ends = backends().each_ref().map(|backend| {
            let label = format!("{most} on the {}", name(backend));
            let outcome = run(&smoother, &options, backend);
            assert_eq!(outcome.stop, Stop::Converged, "{label}");
            let change = Change::between(topology, &mesh.points, &outcome.points).unwrap();
            assert!(change.moved.most <= most, "{label}: {:?}", change.moved);
            assert!(most > 1.0 || change.moved.most > 0.999 * most, "{label}: {:?}", change.moved);
            assert!(check::is_valid(&with_points(&mesh, &outcome.points)), "{label}");
            let f = history(&outcome, Metric::Imr);
            assert!(f.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-6)), "{label}: {f:?}");
            f[f.len() - 1]
        });
        assert!((ends[0] / ends[1] - 1.0).abs() < 1e-4, "{most}: {ends:?}");
        assert!(ends[0] < least, "{most}: {ends:?}");
        least = ends[0];
    }
    let free =
        *history(&run(&smoother, &Options::default(), &Backend::Cpu), Metric::Imr).last().unwrap();
    assert!((least / free - 1.0).abs() < 1e-5, "{least} {free}");
}

/// A bounded run without sweeps ends on both engines, although a device does not end runs that the host judges.
#[test]
fn a_bounded_run_of_no_sweeps_ends() {
    let mesh = support::perturb_random(&plate(300), 0.5, 3);
    let smoother = Smoother::new(&mesh).unwrap();
    let start = Options::default().max_sweeps(0).max_move(Some(0.3));
    for method in [Method::RELAXED, Method::Multilevel] {
        let options = start.clone().method(method);
        for backend in backends() {
            let outcome = run(&smoother, &options, backend);
            assert_eq!((outcome.stop, outcome.sweeps), (Stop::MaxSweeps, 0), "{}", name(backend));
            assert_eq!(outcome.points, mesh.points);
        }
    }
}

/// At the end, no single vertex can lower the objective much within its bound.
#[test]
fn the_end_of_a_bounded_run_is_an_optimum() {
    let mesh = support::perturb_random(&plate(300), 0.5, 3);
    let smoother = Smoother::new(&mesh).unwrap();
    let most = 0.2;
    let options = Options::default().max_move(Some(most)).stopping(Stopping::Tolerance(1e-8));
    let outcome = run(&smoother, &options, &Backend::Cpu);
    let f = |points: &[[f64; 2]]| smoother.f(Metric::Imr, points).unwrap();
    let (start, end) = (f(&mesh.points), f(&outcome.points));
    let mut gained = 0.0;
    let topology = smoother.topology();
    for v in (0..mesh.points.len()).filter(|&v| topology.free()[v]) {
        let mut points = outcome.points.clone();
        let [x, y] = points[v];
        let mut best = end;
        for k in 0..16 {
            let [cos, sin] = support::trig::on_circle(f64::from(k) / 16.0);
            points[v] = [x + 1e-3 * cos, y + 1e-3 * sin];
            let change = Change::between(topology, &mesh.points, &points).unwrap();
            if change.moved.most <= most && check::is_valid(&with_points(&mesh, &points)) {
                best = best.min(f(&points));
            }
        }
        gained += end - best;
    }
    assert!(gained < 0.01 * (start - end), "{gained} of {start} - {end}");
}

#[test]
fn targets_are_seen_by_a_bounded_run_as_well() {
    let mesh = support::perturb_random(&plate(300), 0.5, 3);
    let targets = Targets::tensors(&vec![[1.0, 0.0, 4.0]; mesh.points.len()]).unwrap();
    let mut smoother = Smoother::new(&mesh).unwrap();
    smoother.set_targets(&targets).unwrap();
    let options = Options::default().max_move(Some(0.2));
    let outcome = run(&smoother, &options, &Backend::Cpu);
    let f = history(&outcome, Metric::Imr);
    let end = smoother.f(Metric::Imr, &outcome.points).unwrap();
    assert!((end / f[f.len() - 1] - 1.0).abs() < 1e-9 && end < 0.9 * f[0], "{end} {f:?}");
}

/// Returns the mean length of the edges at a vertex, counting each edge once.
fn mean_edge(mesh: &Mesh, v: u32) -> f64 {
    let at = |t: &&[u32; 3]| t.contains(&v);
    let ends: BTreeSet<&u32> =
        mesh.triangles.iter().filter(at).flatten().filter(|&&end| end != v).collect();
    let [x, y] = mesh.points[v as usize];
    let length = |&end: &u32| {
        let [a, b] = mesh.points[end as usize];
        (x - a).hypot(y - b)
    };
    let lengths: Vec<f64> = ends.into_iter().map(length).collect();
    lengths.iter().sum::<f64>() / lengths.len() as f64
}

#[test]
fn vertices_that_slide_have_a_bound_as_well() {
    let mesh = support::perturb_random(&plate(300), 0.5, 3);
    let mut smoother = Smoother::new(&mesh).unwrap();
    let ends = |smoother: &Smoother, most: f64, backend: &Backend| {
        let options = Options::default().max_move(Some(most));
        let outcome = run(smoother, &options, backend);
        let f = history(&outcome, Metric::Imr);
        assert!(f.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-6)), "{most}: {f:?}");
        assert!(check::is_valid(&with_points(&mesh, &outcome.points)));
        (outcome, f[f.len() - 1])
    };
    let (_, still) = ends(&smoother, 0.2, &Backend::Cpu);
    smoother.set_slide(Some(&Slide::default())).unwrap();
    for (most, backend) in [(0.2, &backends()[0]), (0.1, &backends()[1])] {
        let (outcome, f) = ends(&smoother, most, backend);
        let label = format!("{most} on the {}", name(backend));
        assert_eq!(outcome.stop, Stop::Converged, "{label}");
        assert!(most < 0.2 || f < 0.99 * still, "{label}: {f} {still}");
        // The distance that a vertex moved, relative to its bound.
        let share = |v: u32| {
            let ([x, y], [a, b]) = (mesh.points[v as usize], outcome.points[v as usize]);
            (x - a).hypot(y - b) / (most * mean_edge(&mesh, v))
        };
        let fixed = |v: &u32| !smoother.topology().free()[*v as usize];
        let all = 0..mesh.points.len() as u32;
        assert!(all.clone().all(|v| share(v) <= 1.0), "{label}");
        let at_bound = all.filter(fixed).filter(|&v| share(v) > 0.99).count();
        assert!(at_bound > 5, "{label}: {at_bound}");
        assert!(outcome.slid.unwrap().moved > at_bound, "{label}");
    }
    // A bound that no vertex reaches does not change the result.
    let (_, far) = ends(&smoother, 50.0, &Backend::Cpu);
    let free = history(&run(&smoother, &Options::default(), &Backend::Cpu), Metric::Imr);
    assert!((far / free[free.len() - 1] - 1.0).abs() < 1e-5, "{far} {free:?}");
}

#[test]
fn bounds_that_make_no_sense_are_refused() {
    let mesh = plate(300);
    let smoother = Smoother::new(&mesh).unwrap();
    for max_move in [0.0, f64::NAN] {
        let options = Options::default().max_move(Some(max_move));
        let error = smoother.run(&options).on(&Backend::Cpu).block();
        let error = error.unwrap_err();
        let is_it = match &error {
            SmoothError::Option(OptionError::OutOfRange { option, .. }) => *option == "max move",
            _ => false,
        };
        assert!(is_it, "{error}");
    }
}

/// A coordinate near 0 has a smaller rounding error at the start of a move than at the end.
#[test]
fn rounding_to_single_precision_takes_no_vertex_beyond_its_bound() {
    for seed in 0..20 {
        let mut mesh = support::perturb_random(&support::lattice(8, 8), 0.9, seed);
        let middle = mesh.points.len() / 2;
        let [x, y] = mesh.points[middle];
        // Vertices near an axis, as a file of 32-bit numbers holds them.
        mesh.points.iter_mut().for_each(|p| *p = [p[0] - x, p[1] - y].map(|x| f64::from(x as f32)));
        let smoother = Smoother::new(&mesh).unwrap();
        for most in [0.05, 0.3] {
            let options = Options::default().max_move(Some(most)).stored(Precision::Single);
            let outcome = run(&smoother, &options, &Backend::Cpu);
            let change =
                Change::between(smoother.topology(), &mesh.points, &outcome.points).unwrap();
            assert!(change.moved.most <= most, "mesh {seed}: {} of {most}", change.moved.most);
        }
    }
}
