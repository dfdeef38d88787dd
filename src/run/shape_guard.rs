//! The guards of a run, which bound how far triangles may be flattened.

use glam::DVec2;

use crate::layout::Problem;
use crate::options::Guard;
use crate::parallel::map_parts;
use crate::run::plan::Plan;

/// Sets the guards of a run from these positions. The bound is the largest inverse mean ratio among the triangles with
/// a free vertex. It applies to metrics without a barrier, which do not measure shape and could flatten a good mesh,
/// and with [`Guard::Worst`] to all.
pub(crate) fn set_guards(plan: &mut Plan, guard: Guard, problem: &Problem, positions: &[DVec2]) {
    let is_finite = |guard: f64| guard.is_finite();
    let metrics = plan.scheme.metrics();
    let needs_one = metrics.iter().any(|metric| is_finite(metric.properties().shape_guard));
    if guard == Guard::Worst || needs_one {
        plan.shape_guard = worst_movable(problem, positions);
    }
    if guard == Guard::Worst {
        plan.worst_guard = plan.shape_guard;
    }
}

/// Returns the largest inverse mean ratio among the triangles with a free vertex, infinite if one of them is inverted or flat.
pub(crate) fn worst_movable(problem: &Problem, positions: &[DVec2]) -> f64 {
    let ratio = |t: &[u32; 3]| {
        if !problem.can_move(t) {
            return 1.0;
        }
        problem.corner(t, |v| positions[v as usize]).inverse_mean_ratio()
    };
    let worst = map_parts(problem.triangles().chunks(4096), |_, chunk| {
        chunk.iter().map(ratio).fold(1.0, f64::max)
    });
    worst.into_iter().fold(1.0, f64::max)
}
