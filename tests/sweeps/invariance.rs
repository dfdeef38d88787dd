//! Independence of results from position, unit, windings, numbering, and the size of the smallest triangle.

use crate::{backends, history, is_of_angles, name, perturbed, plate, run};
use gpu_smooth::{Backend, Mesh, Method, Metric, Options, Smoother, Stopping};
use support::transformed;

fn mild() -> Mesh {
    support::perturb_random(&plate(800), 0.6, 4)
}

fn thirty_sweeps(metric: Metric, method: Method) -> Options {
    let scheme = metric.into();
    Options::default()
        .scheme(scheme)
        .method(method)
        .stopping(Stopping::Tolerance(0.0))
        .max_sweeps(30)
}

/// Largest differences between two results: the distance of a vertex in typical edge lengths, and f.
struct Bounds {
    distance: f64,
    f: f64,
}

/// Bounds for runs with corrections, which both engines compute in single precision.
const CORRECTED: Bounds = Bounds { distance: 1e-7, f: 1e-10 };
/// Bounds for rounding in double precision. EDGE and AREA amplify rounding a hundredfold over thirty sweeps.
const CPU: Bounds = Bounds { distance: 1e-11, f: 1e-12 };
/// Bounds for metrics with penalties on angles, whose over-relaxed steps from large angles depend on rounding.
const OF_ANGLES: Bounds = Bounds { distance: 0.1, f: 1e-3 };
/// Bounds for rounding in single precision.
const GPU: Bounds = Bounds { distance: 2e-4, f: 2e-6 };

/// Checks that the result for `there` is the scaled and shifted result for `here`.
fn check(here: &Mesh, there: &Mesh, scale: f64, shift: [f64; 2], bounds: [Bounds; 2]) {
    let edge = (support::area(there) / there.triangles.len() as f64).sqrt() * 1.5;
    let (a, b) = (Smoother::new(here).unwrap(), Smoother::new(there).unwrap());
    let alone = Metric::ALL.iter().map(|&metric| (metric, Method::RELAXED));
    let corrected = [Metric::Rms, Metric::Imr].map(|metric| (metric, Method::Multilevel));
    for (metric, method) in alone.chain(corrected) {
        for (backend, bounds) in backends().iter().zip(&bounds) {
            let options = thirty_sweeps(metric, method);
            let corrected = options.is_multilevel() && matches!(backend, Backend::Cpu);
            let bounds = match (is_of_angles(metric), corrected) {
                (true, _) => &OF_ANGLES,
                (false, true) => &CORRECTED,
                (false, false) => bounds,
            };
            let (a, b) = (run(&a, &options, backend), run(&b, &options, backend));
            let image = Mesh { points: a.points.clone(), ..Mesh::default() };
            let image = transformed(&image, scale, shift);
            let distances = image.points.iter().zip(&b.points);
            let distances =
                distances.map(|(&p, &q)| support::check::squared_distance(p, q).sqrt() / edge);
            let distance = distances.fold(0.0, f64::max);
            let f = (history(&b, metric)[30] / history(&a, metric)[30] - 1.0).abs();
            let label =
                format!("{method:?} {metric} times {scale} by {shift:?} on the {}", name(backend));
            assert!(distance < bounds.distance, "{label}: {distance:e}");
            assert!(f < bounds.f, "{label}: {f:e}");
        }
    }
}

#[test]
fn the_unit_does_not_matter() {
    let mesh = mild();
    for scale in [1e-3, 1e6] {
        check(&mesh, &transformed(&mesh, scale, [0.0; 2]), scale, [0.0; 2], [CPU, GPU]);
    }
}

#[test]
fn the_place_does_not_matter() {
    let mesh = mild();
    for (scale, shift) in [(1.0, [5e5, 4e6]), (1e-3, [-3.0, 7.0])] {
        // Far from the origin, the input itself is rounded, by at most 1e-8 of an edge.
        let rounded = Bounds { distance: 2e-5, f: 1e-7 };
        check(&mesh, &transformed(&mesh, scale, shift), scale, shift, [rounded, GPU]);
    }
}

#[test]
fn windings_do_not_matter() {
    let mesh = mild();
    let mut clockwise = mesh.clone();
    clockwise.triangles.iter_mut().for_each(|t| t.swap(0, 2));
    check(&mesh, &clockwise, 1.0, [0.0; 2], [CPU, GPU]);
    check(&mesh, &support::shuffled_windings(&mesh, 6), 1.0, [0.0; 2], [CPU, GPU]);
}

#[test]
fn the_comparison_of_runs_fails_for_a_slightly_different_mesh() {
    let mesh = mild();
    let other = transformed(&mesh, 1.0 + 1e-3, [0.0; 2]);
    let told = std::panic::catch_unwind(|| check(&mesh, &other, 1.0, [0.0; 2], [CPU, GPU]));
    assert!(told.is_err());
}

#[test]
fn numbering_does_not_matter_to_the_optimum() {
    let mesh = perturbed();
    let (other, new_index) = support::renumbered(mesh, 8);
    for metric in [Metric::Rms, Metric::Imr] {
        let options = Options::default().scheme(metric.into()).stopping(Stopping::Tolerance(1e-8));
        for backend in backends() {
            let (a, b) = (Smoother::new(mesh).unwrap(), Smoother::new(&other).unwrap());
            let (a, b) = (run(&a, &options, backend), run(&b, &options, backend));
            let [fa, fb] = [&a, &b].map(|o| *history(o, metric).last().unwrap());
            // By their own estimates, both results are within 1.5e-8 of the optimum; single precision adds 5e-8.
            assert!((fb / fa - 1.0).abs() < 1e-7, "{metric} on the {}: {fa} {fb}", name(backend));
            let far = a.points.iter().zip(&new_index).map(|(&p, &new)| {
                support::check::squared_distance(p, b.points[new as usize]).sqrt()
            });
            // f is flat at its minimum, so vertices differ by the square root of the difference in f, over an edge of
            // 0.06.
            let far = far.fold(0.0, f64::max);
            assert!(far < 2e-4, "{metric} on the {}: {far:e}", name(backend));
        }
    }
}

#[test]
fn triangles_a_ten_millionth_of_the_domain_are_smoothed_like_any() {
    let mesh = support::perturb_random(&support::graded(24, 1e-7), 0.8, 9);
    let smoother = Smoother::new(&mesh).unwrap();
    for &metric in Metric::ALL {
        // EDGE has many minima, and with corrections, rounding decides in which minimum a run ends.
        let method = if metric.is_smooth() { Method::Auto } else { Method::RELAXED };
        let options = Options::default().method(method).max_sweeps(400);
        let options = options.scheme(metric.into());
        let [cpu, gpu] = backends().each_ref().map(|backend| {
            let outcome = run(&smoother, &options, backend);
            let after = crate::with_points(&mesh, &outcome.points);
            assert!(support::is_valid(&after) && support::is_ccw(&after), "{metric}");
            assert_eq!(outcome.returned, 0, "{metric} left this to the certificate");
            *history(&outcome, metric).last().unwrap()
        });
        // AREA hardly depends on the small triangles, so their final shapes are arbitrary. SHAPE-SIZE and similar
        // metrics depend on the small triangles alone, by 1e10 each, and cannot reach even sizes, so no run converges.
        let properties = metric.properties();
        let is_of_size = properties.barrier && !properties.scale_invariant;
        if metric != Metric::Area && !is_of_size {
            assert!((gpu / cpu - 1.0).abs() < 1e-6, "{metric}: {gpu} for {cpu}");
        }
    }
}
