//! Runs on meshes in which triangles without a free vertex make up nearly all of f.

use gpu_smooth::{
    Backend, Goal, Mesh, Metric, Options, Outcome, Smoother, Stop, Stopping, slide::Slide,
};
use support::SplitMix64;

use crate::{backends, name, run};

/// Number of vertices in a row of the meshes.
const COLUMNS: u32 = 25;
/// Number of rows of vertices that stay fixed above the lower side.
const LAYER: u32 = 4;

/// Returns a lattice with perturbed inner vertices on top of fixed rows whose triangles are `ratio` times as wide as high.
/// The second mesh is the lattice without the fixed rows, and the third lists its vertices by their numbers in the first.
fn on_a_layer(ratio: f64) -> (Mesh, Mesh, Vec<u32>) {
    let mut mesh = support::lattice(COLUMNS as usize - 1, 20);
    let row_of = |v: usize| v as u32 / COLUMNS;
    let step = mesh.points[COLUMNS as usize][1] - mesh.points[0][1];
    let mut rng = SplitMix64::new(7);
    let (width, height) = (COLUMNS as usize, mesh.points.len() / COLUMNS as usize);
    for v in 0..mesh.points.len() {
        let row = row_of(v);
        let is_inner = v % width != 0 && v % width != width - 1 && v / width != height - 1;
        if row < LAYER {
            mesh.points[v][1] = step * (f64::from(LAYER) - f64::from(LAYER - row) / ratio);
        } else if row > LAYER && is_inner {
            mesh.points[v][0] += step * rng.range(-0.4, 0.4);
            mesh.points[v][1] += step * rng.range(-0.4, 0.4);
        }
    }
    let of_layer = |v: &u32| row_of(*v as usize) <= LAYER;
    let vertices = 0..mesh.points.len() as u32;
    mesh.fixed = vertices.clone().filter(of_layer).collect();
    let kept: Vec<u32> = vertices.filter(|v| row_of(*v as usize) >= LAYER).collect();
    let first = LAYER * COLUMNS;
    let above: Vec<[u32; 3]> = mesh
        .triangles
        .iter()
        .filter(|t| t.iter().all(|&v| v >= first))
        .map(|t| t.map(|v| v - first))
        .collect();
    let points = kept.iter().map(|&v| mesh.points[v as usize]).collect();
    let alone = Mesh { points, triangles: above, ..Mesh::default() };
    (mesh, alone, kept)
}

/// Returns the largest distance between the vertices of the lattice in two results.
fn distance(with_layer: &Outcome, alone: &Outcome, kept: &[u32]) -> f64 {
    let pairs = kept.iter().zip(&alone.points);
    let distance = |(&v, q): (&u32, &[f64; 2])| {
        let p = with_layer.points[v as usize];
        (p[0] - q[0]).hypot(p[1] - q[1])
    };
    pairs.map(distance).fold(0.0, f64::max)
}

/// A former defect: fixed triangles of 1e12 of f hid every gain, and the run returned the mesh unchanged.
#[test]
fn fixed_slivers_do_not_hide_the_gain_of_a_run() {
    let (mesh, alone, kept) = on_a_layer(1e7);
    for backend in backends() {
        for tolerance in [1e-6, 0.0] {
            let stopping = Stopping::Tolerance(tolerance);
            let options = Options::default().stopping(stopping).max_sweeps(60);
            let smoother = Smoother::new(&mesh).unwrap();
            let outcome = run(&smoother, &options, backend);
            let expected = run(&Smoother::new(&alone).unwrap(), &options, backend);
            let label = format!("{}, tolerance {tolerance}", name(backend));
            let far = distance(&outcome, &expected, &kept);
            assert!(far < 1e-3, "{label}: {far} from the result without the layer");
            if tolerance > 0.0 {
                assert_eq!(outcome.stop, Stop::Converged, "{label}");
                let [sweeps, few] = [outcome.sweeps, expected.sweeps];
                assert!(sweeps.abs_diff(few) <= 2, "{label}: {sweeps} sweeps, {few} alone");
            }
            // Both means have the same triangles but two, which are at the ends of the layer.
            let [before, after] = outcome.movable_f;
            let [f_before, f_after] = expected.movable_f;
            assert!((before - f_before).abs() < 1e-6 * f_before, "{label}: {before} {f_before}");
            assert!((after - f_after).abs() < 1e-5 * f_after, "{label}: {after} {f_after}");
        }
    }
}

/// The history states f over all triangles, although the run is judged by fewer.
#[test]
fn a_history_has_the_mean_over_all_triangles() {
    let (mesh, ..) = on_a_layer(30.0);
    let smoother = Smoother::new(&mesh).unwrap();
    for backend in backends() {
        for metric in [Metric::Imr, Metric::ShapeSize, Metric::Edge] {
            let options = Options::default().scheme(metric.into()).track_all(true);
            let outcome = run(&smoother, &options, backend);
            let precise = if matches!(backend, Backend::Cpu) { 1e-12 } else { 1e-5 };
            let ends = [
                (&mesh.points, outcome.history.first()),
                (&outcome.points, outcome.history.last()),
            ];
            for (points, objectives) in ends {
                for tracked in [metric, Metric::Imr] {
                    let f = smoother.f(tracked, points).unwrap();
                    let stated = objectives.unwrap().of(tracked).unwrap();
                    let label =
                        format!("{metric} on the {}: {tracked} {stated} {f}", name(backend));
                    assert!((stated - f).abs() <= precise * f, "{label}");
                }
            }
        }
    }
}

#[test]
fn a_desired_objective_is_a_mean_over_all_triangles() {
    let (mesh, ..) = on_a_layer(30.0);
    let smoother = Smoother::new(&mesh).unwrap();
    let converged = run(&smoother, &Options::default(), &Backend::Cpu);
    let [first, last] = [converged.history.first(), converged.history.last()]
        .map(|f| f.unwrap().of(Metric::Imr).unwrap());
    let desired = 0.5 * (first + last);
    let goal = Goal { fraction: 1.0, desired: Some(desired) };
    let options = Options::default().stopping(Stopping::Goal(goal));
    let outcome = run(&smoother, &options, &Backend::Cpu);
    assert_eq!(outcome.stop, Stop::Reached);
    let f = |k: usize| outcome.history[k].of(Metric::Imr).unwrap();
    let sweeps = outcome.sweeps as usize;
    assert!(f(sweeps) <= desired && f(sweeps - 1) > desired, "{} {desired}", f(sweeps));
    assert_eq!(outcome.goal.unwrap().desired, desired);
}

/// Triangles at vertices that slide are judged, although no corner of such a triangle is free.
#[test]
fn sliding_runs_are_judged_by_triangles_that_slide() {
    let (mesh, ..) = on_a_layer(1e7);
    let mut smoother = Smoother::new(&mesh).unwrap();
    let fixed = mesh.fixed.clone();
    assert!(smoother.set_slide(Some(&Slide { held: fixed, ..Slide::default() })).unwrap() > 0);
    let outcome = run(&smoother, &Options::default(), &Backend::Cpu);
    assert!(outcome.slid.unwrap().moved > 0);
    let [before, after] = outcome.movable_f;
    assert!(after < 0.9 * before, "{before} {after}");
}
