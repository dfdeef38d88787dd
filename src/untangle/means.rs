//! Feasible positions near means of neighbors, at which a run can begin.

use glam::DVec2;

use crate::layout::Problem;
use crate::parallel::pace::now;
use crate::run::regularization::epsilon;
use crate::topology::overlapping_star;
use crate::topology::predicates::not_positive;
use crate::untangle::state::{Region, State};

/// Largest number of untangling sweeps. Means of neighbors invert triangles at holes and in bays of the boundary.
const SWEEPS: u32 = 30;

/// Returns positions near equally weighted means of neighbors, at which every triangle is feasible. Fixed vertices keep
/// their positions `from`. `None` if [`SWEEPS`] untangling sweeps leave an inverted or flat triangle, or a vertex around
/// which triangles wind more than once.
pub(crate) fn feasible_means(problem: &Problem, from: &[DVec2]) -> Option<Vec<DVec2>> {
    let nobody = vec![false; problem.free_count()];
    // With equal target areas, all neighbors have equal weights. Weights by the sizes of triangles would leave triangles
    // at fixed vertices nearly as flat as before.
    let areas = vec![problem.mean_area(); from.len()];
    let mut state = State::new(problem, areas);
    state.positions = from.to_vec();
    let levels = state.hierarchy(&nobody);
    state.make_harmonic(&levels, &nobody);
    let region = Region::whole(problem);
    let mut assessment = state.assess(&region);
    for _ in 0..SWEEPS {
        if assessment.bad == 0 {
            break;
        }
        let epsilon = epsilon(assessment.least);
        state.sweep(&region, epsilon);
        state.global_step(&region, &levels, epsilon);
        assessment = state.assess(&region);
    }
    let points: Vec<[f64; 2]> = state.positions.iter().map(|p| p.to_array()).collect();
    let free: Vec<bool> = (0..points.len()).map(|v| v < problem.free_count()).collect();
    let is_feasible = now(not_positive(&points, problem.corners().all())).is_empty()
        && overlapping_star(&points, problem.corners(), &free).is_none();
    is_feasible.then_some(state.positions)
}
