//! Strongly stretched meshes, on which Newton directions and coarser levels use local coordinates.

use crate::{backends, history, name, run, support, with_points};
use gpu_smooth::{Backend, Mesh, Metric, Options, Smoother, Stop, Stopping};
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
    Mesh { points, triangles, fixed: vec![] }
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
    Mesh { points, triangles: (0..degree).flat_map(around).collect(), fixed: vec![] }
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

#[test]
fn the_promise_holds_around_a_vertex_of_3000() {
    let mesh = wheel(3000);
    let outcome = run(&Smoother::new(&mesh).unwrap(), &Options::default(), &Backend::Cpu);
    assert_eq!(outcome.stop, Stop::Converged);
    let f = *history(&outcome, Metric::Imr).last().unwrap();
    let after = with_points(&mesh, &outcome.points);
    let long = Options { stopping: Stopping::Tolerance(1e-10), ..Options::default() };
    let further = run(&Smoother::new(&after).unwrap(), &long, &Backend::Cpu);
    let left = 1.0 - history(&further, Metric::Imr).last().unwrap() / f;
    let said = outcome.remaining.unwrap();
    assert!(left < 2.0 * said, "{left:e} left, {said:e} said");
}
