//! The shape guard: how far metrics without a barrier may flatten triangles.

use glam::DVec2;

use crate::layout::Problem;
use crate::metric::Scheme;
use crate::parallel::map_parts;

/// The shape guard of a run: the largest inverse mean ratio among the triangles with a free vertex. No step may leave a
/// triangle worse than that, so metrics that do not measure shape cannot flatten a good mesh. Infinite if every metric
/// of the scheme has a barrier.
pub(crate) fn shape_guard(problem: &Problem, positions: &[DVec2], scheme: &Scheme) -> f64 {
    if scheme.metrics().iter().all(|metric| metric.properties().shape_guard.is_infinite()) {
        return f64::INFINITY;
    }
    let free = problem.free_count() as u32;
    let ratio = |t: &[u32; 3]| {
        if t.iter().all(|&v| v >= free) {
            return 1.0;
        }
        problem.corner(t, |v| positions[v as usize]).inverse_mean_ratio()
    };
    let worst = map_parts(problem.triangles().chunks(4096), |_, chunk| {
        chunk.iter().map(ratio).fold(1.0, f64::max)
    });
    worst.into_iter().fold(1.0, f64::max)
}
