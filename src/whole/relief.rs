//! The start of a run on a mesh with extremely flat triangles that sweeps do not open.
//!
//! A sweep moves a vertex next to a triangle of inverse mean ratio 1e12 until the triangles on its other side are nearly
//! as flat. Where many vertices are close to one long edge, their triangles become clusters of 1e-8 of the edge, in which
//! every vertex is at the minimum of its own patch. Each sweep then lowers f by less than a percent, and a correction from
//! the coarser levels moves no vertex farther than the size of a cluster. A run from means of neighbors has no clusters.

use glam::DVec2;

use crate::cpu::{CpuEngine, objectives};
use crate::error::GpuError;
use crate::layout::Problem;
use crate::parallel::pace::pause;
use crate::parallel::paced;
use crate::run::{Engine, History, Objectives, Plan, sweeps, worst_movable};
use crate::untangle::feasible_means;

/// Largest inverse mean ratio of a triangle with a free vertex, above which sweeps are tried before a run. Among 130 meshes
/// with ratios of 1e6 to 1e8, sweeps leave two with f = 1.7e5 after 1,000 sweeps. From means of neighbors, 101 sweeps reach
/// f = 2.07.
const EXTREME: f64 = 1e6;
/// Largest inverse mean ratio after the trial sweeps, below which sweeps open the mesh, and the run begins at the given
/// positions.
const OPENED: f64 = 100.0;
/// Number of trial sweeps. Sweeps open most triangles that are as flat as double precision permits in fewer than 25.
const TRIAL: u32 = 40;
/// Share of f after the trial sweeps, below which f must be at means of neighbors.
const GAIN: f64 = 0.1;

/// The start of a run at means of neighbors.
pub(super) struct Relief {
    /// Tracked objectives at the given positions.
    pub(super) given: Objectives,
    /// Normalized positions of all vertices, near means of neighbors.
    pub(super) positions: Vec<DVec2>,
}

/// Returns the start of a run with corrections on a mesh with an extremely flat triangle. `None` if the run begins at the
/// given positions `from`: if [`TRIAL`] sweeps open the mesh, or if f is not much lower and the worst triangle no better
/// at means of neighbors. Runs of [`TRIAL`] sweeps or fewer, and runs by a metric without a barrier, always begin at
/// `from`. `with_maps` is `problem` with the local maps of a run from `from`.
///
/// The result depends on the arguments alone, so a run that continues from a checkpoint has the start of the first run.
pub(super) async fn relieved(
    problem: &Problem,
    with_maps: &Problem,
    plan: &Plan,
    from: &[DVec2],
) -> Result<Option<Relief>, GpuError> {
    let base = plan.scheme.base();
    let has_barrier = base.properties().barrier;
    if !has_barrier || plan.stop.max_sweeps <= TRIAL || problem.free_count() == 0 {
        return Ok(None);
    }
    let worst = worst_movable(problem, from).await;
    if worst <= EXTREME {
        return Ok(None);
    }
    let trial = plan.clone().endless();
    let mut engine = CpuEngine::new(with_maps, paced::copied(from).await, None, &trial);
    let mut history = History::new(&trial);
    let period = trial.scheme.period();
    for _ in 0..TRIAL.div_ceil(period) {
        sweeps::advance(&mut engine, &trial, &mut history, period).await?;
        if worst_movable(problem, &engine.positions().await?).await <= OPENED {
            return Ok(None);
        }
        pause().await;
    }
    let Some(positions) = feasible_means(problem, from) else { return Ok(None) };
    let f = objectives(&plan.tracked(), problem, &positions).await.of(base).unwrap_or(f64::NAN);
    let is_better = f < GAIN * history.least() && worst_movable(problem, &positions).await < worst;
    if !is_better {
        return Ok(None);
    }
    let given = objectives(&plan.tracked(), problem, from).await;
    Ok(Some(Relief { given, positions }))
}
