//! The stage after a run that improves the worst triangles.

use glam::DVec2;

use crate::layout::Problem;
use crate::parallel::{collect, map_parts};
use crate::patch::FanCorner;
use crate::worst::badness::Badness;
use crate::worst::region::{MoveConstraints, Region};
use crate::worst::regions::around;

/// Number of triangles of the mesh for each triangle that a pass improves. The worst triangles with a free vertex come
/// first.
const SHARE: usize = 1000;
/// Smallest number of triangles that a pass improves.
const FEWEST: usize = 10;
/// Largest number of triangles that a pass improves, so that the stage takes only seconds on the largest meshes.
const MAX_WORST: usize = 1000;
/// Number of rings of vertices around the worst triangles that move too. With three rings, the worst triangle improves
/// no further, and f rises more.
const RINGS: u32 = 2;
/// Largest number of passes.
const PASSES: u32 = 10;
/// Relative drop of the worst badness below which no further pass follows. The inverse mean ratio drops by half this
/// share, as badness is its square.
const MIN_GAIN: f64 = 0.01;
/// Relative drop of the worst badness below which a pass is undone and the stage ends. For the first pass, 2e-3 is a
/// thousandth of the measure, whose square is the badness. For later passes, 1e-9 excludes gains by rounding.
const MIN_KEPT: [f64; 2] = [2e-3, 1e-9];

/// Returns the largest badness among triangles with a free vertex.
pub(crate) fn worst_movable(problem: &Problem, badness: Badness, positions: &[DVec2]) -> f64 {
    worst_of(problem, &all(problem, badness, positions))
}

fn worst_of(problem: &Problem, badness: &[f64]) -> f64 {
    let movable = problem.triangles().iter().zip(badness).filter(|(t, _)| problem.can_move(t));
    movable.map(|(_, badness)| *badness).fold(0.0, f64::max)
}

/// Returns the number of triangles that are worse than every triangle with a free vertex, but have only fixed corners.
/// Corners in `slides`, an ascending list, do not count as fixed.
pub(crate) fn stuck(
    problem: &Problem,
    badness: Badness,
    positions: &[DVec2],
    slides: &[u32],
) -> usize {
    let all = all(problem, badness, positions);
    let worst = worst_of(problem, &all);
    let stays =
        |t: &[u32; 3]| !problem.can_move(t) && t.iter().all(|v| slides.binary_search(v).is_err());
    let pairs = problem.triangles().iter().zip(&all);
    pairs.filter(|(t, badness)| **badness > worst && stays(t)).count()
}

/// Returns the badness of every triangle of the problem.
fn all(problem: &Problem, badness: Badness, positions: &[DVec2]) -> Vec<f64> {
    collect(problem.triangles().len(), |t| {
        let t = problem.triangles()[t];
        let [p, q, r] = t.map(|v| positions[v as usize]);
        let triangle = FanCorner { ends: [q, r], map: problem.target_map(&t) };
        badness.of(&badness.seen(&triangle, p, problem.mean_area()))
    })
}

/// Improves the worst triangles of a mesh with its vertices at `positions`, in independent regions. Passes continue
/// while the worst triangle of the mesh becomes less bad. `goes_on`, called before each pass, may end them. A pass
/// without a sufficient gain is undone. No triangle becomes worse than the former worst triangle of its region. Returns
/// the number of vertices that moved.
pub(crate) fn improve(
    problem: &Problem,
    rules: &MoveConstraints<'_>,
    positions: &mut [DVec2],
    mut goes_on: impl FnMut(&[DVec2]) -> bool,
) -> usize {
    let free = problem.free_count() as u32;
    let mut has_moved = vec![false; free as usize];
    let count = (problem.triangles().len() / SHARE).clamp(FEWEST, MAX_WORST);
    let mut badness = all(problem, rules.badness, positions);
    let mut worst = worst_of(problem, &badness);
    for pass in 0..PASSES {
        if !goes_on(positions) {
            break;
        }
        let can_move = |&t: &u32| problem.can_move(&problem.triangles()[t as usize]);
        let mut bad: Vec<u32> = (0..badness.len() as u32).filter(can_move).collect();
        let worse_first = |a: &u32, b: &u32| {
            let [x, y] = [a, b].map(|&t| badness[t as usize]);
            y.total_cmp(&x).then(a.cmp(b))
        };
        if bad.len() > count {
            bad.select_nth_unstable_by(count, worse_first);
            bad.truncate(count);
        }
        let here = &*positions;
        let improved = map_parts(around(problem, &bad, RINGS), |_, vertices| {
            Region::new(problem, rules, here, vertices).improve()
        });
        let moves: Vec<(u32, DVec2)> = improved.into_iter().flatten().flatten().collect();
        let from: Vec<DVec2> = moves.iter().map(|&(v, _)| positions[v as usize]).collect();
        moves.iter().for_each(|&(v, to)| positions[v as usize] = to);
        badness = all(problem, rules.badness, positions);
        let last = std::mem::replace(&mut worst, worst_of(problem, &badness));
        let least = MIN_KEPT[usize::from(pass > 0)];
        let is_kept = worst < last * (1.0 - least);
        if !is_kept {
            moves.iter().zip(from).for_each(|(&(v, _), from)| positions[v as usize] = from);
            break;
        }
        for (&(v, to), from) in moves.iter().zip(from) {
            has_moved[v as usize] |= from != to;
        }
        let is_better = worst < last * (1.0 - MIN_GAIN);
        if !is_better {
            break;
        }
    }
    has_moved.into_iter().filter(|moved| *moved).count()
}
