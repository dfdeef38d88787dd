//! The objective over all triangles.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec2;
use rayon::prelude::*;

use crate::cpu::lanes::{LANES, Lanes};
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
