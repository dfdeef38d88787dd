//! Strongly stretched meshes, on which Newton directions and coarser levels use local coordinates.

use crate::{backends, history, name, run, with_points};
use gpu_smooth::{
    Backend, Mesh, Metric, Options, Smoother, Stop, Stopping, Targets, targets::Surface,
};
use std::f64::consts::TAU;
use support::{SplitMix64, trig::on_circle};

/// Makes a lattice of squares with `free` free vertices on each side. Each square is cut in two, each free vertex is
/// moved by up to 0.3 squares, and all is stretched by `ratio` along x.
fn stretched_lattice(free: usize, ratio: f64) -> Mesh {
    let side = free + 2;
    let mut rng = SplitMix64::new(7);
    let points = (0..side * side).map(|v| {
        let (i, j) = (v % side, v / side);
        let is_free = [i, j].iter().all(|k| (1..side - 1).contains(k));
        let mut moved = || if is_free { 0.6 * (rng.unit() - 0.5) } else { 0.0 };
        [ratio * (i as f64 + moved()), j as f64 + moved()]
    });
    let points = points.collect();
    let squares = (0..(side - 1) * (side - 1)).map(|k| k / (side - 1) * side + k % (side - 1));
    let halves = |a: usize| [[a, a + 1, a + side + 1], [a, a + side + 1, a + side]];
    let triangles = squares.flat_map(halves).map(|t| t.map(|v| v as u32)).collect();
    Mesh { points, triangles, ..Mesh::default() }
}

/// Makes a vertex of `degree` neighbors with two rings of free vertices and a ring of fixed vertices around it. Free
/// vertices are moved by up to a quarter of an edge.
fn wheel(degree: usize) -> Mesh {
    let edge = TAU / degree as f64;
    let mut rng = SplitMix64::new(5);
    let mut points = vec![[0.3, 0.2]];
    for ring in 0..3 {
        for i in 0..degree {
            let mut moved = || if ring < 2 { 0.5 * (rng.unit() - 0.5) } else { 0.0 };
            let turns = (i as f64 + 0.5 * ring as f64 + moved()) / degree as f64;
            let radius = 1.0 + edge * (ring as f64 + moved());
            points.push(on_circle(turns).map(|x| x * radius));
        }
    }
    let at = |ring: usize, i: usize| (1 + ring * degree + i % degree) as u32;
    let around = |i: usize| {
        let between = |k| {
            let (a, b) = (at(k, i), at(k, i + 1));
            [[a, at(k + 1, i), b], [b, at(k + 1, i), at(k + 1, i + 1)]]
        };
        [vec![[0, at(0, i), at(0, i + 1)]], between(0).to_vec(), between(1).to_vec()].concat()
    };
    Mesh { points, triangles: (0..degree).flat_map(around).collect(), ..Mesh::default() }
}

/// The regular lattice is the optimum. All its triangles are right, with legs of lengths `ratio` and 1.
#[test]
fn a_strongly_stretched_lattice_becomes_regular() {
    for (free, ratio) in [(5, 3e4), (31, 1e2), (31, 1e3), (31, 1e4), (31, 1e6)] {
        let mesh = stretched_lattice(free, ratio);
        let smoother = Smoother::new(&mesh).unwrap();
        let optimum = ((ratio * ratio + 1.0) / (3f64.sqrt() * ratio)).powi(2);
        for backend in backends() {
            let label = format!("{free} vertices, 1:{ratio:e}, on the {}", name(backend));
            let outcome = run(&smoother, &Options::default(), backend);
            assert_eq!(outcome.stop, Stop::Converged, "{label}");
            assert!(outcome.sweeps <= 60, "{label}: {} sweeps", outcome.sweeps);
            let left = history(&outcome, Metric::Imr).last().unwrap() / optimum - 1.0;
            assert!(left < 1.5e-6, "{label}: {left:e} left");
            let said = outcome.remaining.unwrap_or(1e-6);
            assert!(left < 2.0 * said + 1e-8, "{label}: {left:e} left, {said:e} said");
        }
    }
}

/// A former defect: with targets, 295 sweeps at 1:100, no end at 1:1000, and 0.9 % left at the end at 1:100000.
#[test]
fn equal_targets_do_not_change_a_run_on_a_strongly_stretched_lattice() {
    for ratio in [1e2, 1e3, 1e5] {
        let mesh = stretched_lattice(19, ratio);
        let mut smoother = Smoother::new(&mesh).unwrap();
        let plain = run(&smoother, &Options::default(), &Backend::Cpu);
        smoother.set_targets(&Targets::equilateral(mesh.points.len())).unwrap();
        for backend in backends() {
            let label = format!("1:{ratio:e} on the {}", name(backend));
            let outcome = run(&smoother, &Options::default(), backend);
            assert_eq!(outcome.stop, Stop::Converged, "{label}");
            let sweeps = [&plain, &outcome].map(|outcome| outcome.sweeps);
            assert!(sweeps[0].abs_diff(sweeps[1]) <= 3, "{label}: {sweeps:?} sweeps");
            let f = [&plain, &outcome].map(|o| *history(o, Metric::Imr).last().unwrap());
            assert!((f[1] / f[0] - 1.0).abs() < 1e-7, "{label}: {f:?}");
            // A device has room for a single map per vertex, so the CPU makes all sweeps.
            let on_cpu = if matches!(backend, Backend::Cpu) { 0 } else { outcome.sweeps };
            assert_eq!(outcome.opening_sweeps, on_cpu, "{label}");
        }
    }
}

/// A former defect: runs with targets converged with up to 18 % left, or not in 1,000 sweeps.
#[test]
fn the_promise_holds_on_strongly_stretched_lattices_with_targets() {
    for ratio in [1e2, 1e4, 1e6] {
        let mesh = stretched_lattice(19, ratio);
        let sizes: Vec<f64> = mesh.points.iter().map(|[_, y]| 1.0 + 0.1 * y).collect();
        let mut smoother = Smoother::new(&mesh).unwrap();
        let kept = Targets::keep_size(smoother.topology(), &mesh.points, Surface::Plane, 0);
        for (targets, of_targets, metric) in [
            (kept.unwrap(), "kept sizes", Metric::Tmop94),
            (Targets::sizes(&sizes).unwrap(), "sizes", Metric::SoftSize),
            (
                Targets::tensors(&vec![[1.0, 0.3, 2.0]; sizes.len()]).unwrap(),
                "tensors",
                Metric::Imr,
            ),
        ] {
            let label = format!("1:{ratio:e}, {of_targets}");
            smoother.set_targets(&targets).unwrap();
            let options = Options::default().scheme(metric.into());
            let outcome = run(&smoother, &options, &Backend::Cpu);
            assert_eq!(outcome.stop, Stop::Converged, "{label}");
            assert!(outcome.sweeps <= 60, "{label}: {} sweeps", outcome.sweeps);
            let long = options.stopping(Stopping::Tolerance(1e-11));
            let further = run(&smoother, &long, &Backend::Cpu);
            let [f, least] = [&outcome, &further].map(|o| *history(o, metric).last().unwrap());
            let left = 1.0 - least / f;
            let said = outcome.remaining.unwrap();
            assert!(left < 2.0 * said, "{label}: {left:e} left, {said:e} said");
        }
    }
}

/// Transformed by their targets, the triangles of this mesh equal those of the stretched lattice in stretching.
#[test]
fn an_even_lattice_with_strongly_stretched_targets_becomes_regular() {
    let ratio = 1e3;
    let mesh = stretched_lattice(19, 1.0);
    let mut smoother = Smoother::new(&mesh).unwrap();
    let tensors = vec![[ratio * ratio, 0.0, 1.0]; mesh.points.len()];
    smoother.set_targets(&Targets::tensors(&tensors).unwrap()).unwrap();
    let outcome = run(&smoother, &Options::default(), &Backend::Cpu);
    let optimum = ((ratio * ratio + 1.0) / (3f64.sqrt() * ratio)).powi(2);
    let left = history(&outcome, Metric::Imr).last().unwrap() / optimum - 1.0;
    assert_eq!(outcome.stop, Stop::Converged);
    assert!(outcome.sweeps <= 60 && left < 1.5e-6, "{} sweeps, {left:e} left", outcome.sweeps);
}

#[test]
fn the_promise_holds_around_a_vertex_of_3000() {
    let mesh = wheel(3000);
    let outcome = run(&Smoother::new(&mesh).unwrap(), &Options::default(), &Backend::Cpu);
    assert_eq!(outcome.stop, Stop::Converged);
    let f = *history(&outcome, Metric::Imr).last().unwrap();
    let after = with_points(&mesh, &outcome.points);
    let long = Options::default().stopping(Stopping::Tolerance(1e-10));
    let further = run(&Smoother::new(&after).unwrap(), &long, &Backend::Cpu);
    let left = 1.0 - history(&further, Metric::Imr).last().unwrap() / f;
    let said = outcome.remaining.unwrap();
    assert!(left < 2.0 * said, "{left:e} left, {said:e} said");
}
