//! The objective over all triangles.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec2;
use rayon::prelude::*;

use crate::cpu::lanes::{LANES, Lanes, Mask};
use crate::cpu::newton::shape_guard;
use crate::cpu::patch::points;
use crate::metric::{Corner, Metric, specialize};
use crate::problem::Problem;

/// Triangles of one task.
const CHUNK: usize = 1024;

/// Mean of q² - ideal² over all triangles, in an order of summation that does not depend on the
/// number of threads.
pub(crate) fn mean_excess(metric: Metric, problem: &Problem, positions: &[DVec2]) -> f64 {
    let level = Level::new();
    let sum = |chunk: &[[u32; 3]]| {
        specialize!(metric, METRIC => {
            dispatch!(level, simd => excess(simd, METRIC, problem.mean_area(), positions, chunk))
        })
    };
    let sums: Vec<f64> = problem.triangles().par_chunks(CHUNK).map(sum).collect();
    sums.iter().sum::<f64>() / problem.triangles().len() as f64
}

/// The same where no triangle is inverted or flat, nor breaks the metric's shape guard and is worse than at
/// `before`; `None` else.
pub(super) fn feasible_mean_excess(
    metric: Metric,
    problem: &Problem,
    before: &[DVec2],
    positions: &[DVec2],
) -> Option<f64> {
    let level = Level::new();
    let feasible = |chunk: &[[u32; 3]]| {
        let feasible = dispatch!(level, simd => all_positive(simd, positions, chunk));
        feasible && chunk.iter().all(|t| keeps_guard(metric, before, positions, t))
    };
    let feasible = problem.triangles().par_chunks(CHUNK).all(feasible);
    feasible.then(|| mean_excess(metric, problem, positions))
}

/// Whether all triangles are counter-clockwise.
#[inline(always)]
fn all_positive<S: Simd>(simd: S, positions: &[DVec2], triangles: &[[u32; 3]]) -> bool {
    let (fours, rest) = triangles.as_chunks::<LANES>();
    let mut positive = Mask::splat(simd, true);
    for [t, u, v, w] in fours {
        let p = points(simd, positions, [t[0], u[0], v[0], w[0]]);
        let q = points(simd, positions, [t[1], u[1], v[1], w[1]]);
        let r = points(simd, positions, [t[2], u[2], v[2], w[2]]);
        let (ax, ay, bx, by) = (q[0] - p[0], q[1] - p[1], r[0] - p[0], r[1] - p[1]);
        positive &= (ax * by - ay * bx).simd_gt(0.0);
    }
    positive.all_true() && rest.iter().all(|t| triangle(positions, t).doubled_area() > 0.0)
}

fn keeps_guard(metric: Metric, before: &[DVec2], positions: &[DVec2], t: &[u32; 3]) -> bool {
    let guard = shape_guard(metric);
    if guard.is_infinite() {
        return true;
    }
    let shape = |positions| Metric::Ar.quality(&triangle(positions, t));
    let now = shape(positions);
    now <= guard || now <= shape(before)
}

/// A triangle, for what no mean area matters to.
fn triangle(positions: &[DVec2], t: &[u32; 3]) -> Corner<f64> {
    let [p, q, r] = t.map(|v| positions[v as usize]);
    Corner { a: (q - p).into(), b: (r - p).into(), mean_area: 1.0 }
}

/// The sum over some triangles.
#[inline(always)]
fn excess<S: Simd>(
    simd: S,
    metric: Metric,
    mean_area: f64,
    positions: &[DVec2],
    triangles: &[[u32; 3]],
) -> f64 {
    let (fours, rest) = triangles.as_chunks::<LANES>();
    let mut sum = Lanes::splat(simd, 0.0);
    for [t, u, v, w] in fours {
        let p = points(simd, positions, [t[0], u[0], v[0], w[0]]);
        let q = points(simd, positions, [t[1], u[1], v[1], w[1]]);
        let r = points(simd, positions, [t[2], u[2], v[2], w[2]]);
        let (a, b) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
        sum += metric.excess(&Corner { a, b, mean_area });
    }
    let mut last = 0.0;
    for t in rest {
        let [p, q, r] = t.map(|v| positions[v as usize]);
        last += metric.excess(&Corner { a: (q - p).into(), b: (r - p).into(), mean_area });
    }
    (sum[0] + sum[1]) + (sum[2] + sum[3]) + last
}
