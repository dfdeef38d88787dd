//! The guards of a run: limits of the inverse mean ratio of triangles.

use glam::DVec2;

use crate::layout::Problem;
use crate::options::Guard;
use crate::parallel::paced;
use crate::run::plan::Plan;

/// Sets the guards of a run by the given positions. The bound is the largest inverse mean ratio among the triangles
/// with a free vertex. The bound applies to metrics without a barrier, which do not measure shape and could flatten a
/// good mesh. With [`Guard::Worst`], the bound applies to all metrics.
pub(crate) async fn set_guards(
    plan: &mut Plan,
    guard: Guard,
    problem: &Problem,
    positions: &[DVec2],
) {
    let is_finite = |guard: f64| guard.is_finite();
    let metrics = plan.scheme.metrics();
    let needs_one = metrics.iter().any(|metric| is_finite(metric.properties().shape_guard));
    if guard == Guard::Worst || needs_one {
        plan.shape_guard = worst_movable(problem, positions).await;
    }
    if guard == Guard::Worst {
        plan.worst_guard = plan.shape_guard;
    }
}

/// Returns the largest inverse mean ratio among the corners with a free vertex. Infinite if such a corner is
/// inverted or flat.
pub(crate) async fn worst_movable(problem: &Problem, positions: &[DVec2]) -> f64 {
    let ratio = |is_right: bool, t: &[u32; 3]| {
        if !problem.can_move(t) {
            return 1.0;
        }
        problem.corner_of(is_right, t, |v| positions[v as usize]).inverse_mean_ratio()
    };
    let parts = problem.corner_parts().into_iter().flat_map(|part| part.chunks(4096));
    let worst = paced::map_parts(parts.collect::<Vec<_>>(), |_, part| {
        part.corners.iter().map(|t| ratio(part.is_right, t)).fold(1.0, f64::max)
    })
    .await;
    worst.into_iter().fold(1.0, f64::max)
}
