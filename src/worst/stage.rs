//! The stage after a run that improves the worst triangles.

use glam::DVec2;

use crate::layout::Problem;
use crate::parallel::paced;
use crate::patch::{FanCorner, Role};
use crate::worst::badness::Badness;
use crate::worst::region::{MoveConstraints, Region};
use crate::worst::regions::around;

/// Number of triangles that one task evaluates.
const CHUNK: usize = 1 << 12;
/// Number of triangles among which one task finds the worst.
const SORTED: usize = 1 << 15;
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
pub(crate) async fn worst_movable(problem: &Problem, badness: Badness, positions: &[DVec2]) -> f64 {
    worst_of(problem, &all(problem, badness, positions).await).await
}

async fn worst_of(problem: &Problem, badness: &[f64]) -> f64 {
    let worst = |_, (triangles, badness): (&[[u32; 3]], &[f64])| {
        let movable = triangles.iter().zip(badness).filter(|(t, _)| problem.can_move(t));
        movable.map(|(_, badness)| *badness).fold(0.0, f64::max)
    };
    let parts = problem.corners().all().chunks(CHUNK).zip(badness.chunks(CHUNK));
    paced::map_parts(parts, worst).await.into_iter().fold(0.0, f64::max)
}

/// Returns the number of elements that are worse than every triangle with a free vertex, but have only fixed vertices.
/// Vertices in `slides`, an ascending list, do not count as fixed. A quadrilateral is as bad as its worst corner.
pub(crate) async fn stuck(
    problem: &Problem,
    badness: Badness,
    positions: &[DVec2],
    slides: &[u32],
) -> usize {
    let all = all(problem, badness, positions).await;
    let worst = worst_of(problem, &all).await;
    let stays =
        |t: &[u32; 3]| !problem.can_move(t) && t.iter().all(|v| slides.binary_search(v).is_err());
    let count = |_, (corners, badness, each): (&[[u32; 3]], &[f64], usize)| {
        let elements = corners.chunks(each).zip(badness.chunks(each));
        let is_worse = |badness: &[f64]| badness.iter().any(|&badness| badness > worst);
        elements.filter(|(corners, badness)| is_worse(badness) && corners.iter().all(stays)).count()
    };
    let corners = problem.corners();
    let (of_triangles, of_quadrilaterals) = all.split_at(corners.triangles().len());
    let lists = [
        (corners.triangles(), of_triangles, 1),
        (corners.of_quadrilaterals(), of_quadrilaterals, 4),
    ];
    let parts = lists.into_iter().flat_map(|(corners, badness, each)| {
        let parts = corners.chunks(CHUNK).zip(badness.chunks(CHUNK));
        parts.map(move |(corners, badness)| (corners, badness, each))
    });
    paced::map_parts(parts.collect::<Vec<_>>(), count).await.into_iter().sum()
}

/// Returns the badness of every triangle of the problem.
async fn all(problem: &Problem, badness: Badness, positions: &[DVec2]) -> Vec<f64> {
    let corners = problem.corners();
    paced::collect(corners.all().len(), |index| {
        let t = corners.all()[index];
        let is_right = !corners.is_triangle(index as u32);
        let [p, q, r] = t.map(|v| positions[v as usize]);
        let role = if is_right { Role::Own } else { Role::Triangle };
        let triangle = FanCorner { ends: [q, r], map: problem.target_map(&t), role };
        badness.of(&badness.seen(&triangle, p, problem.ideal(), problem.coordinates()))
    })
    .await
}

/// Passes that improve the worst triangles of a mesh, in independent regions, while the worst triangle of the mesh
/// becomes less bad. A pass without a sufficient gain is undone. No triangle becomes worse than the former worst triangle
/// of its region.
pub(crate) struct Passes<'a> {
    problem: &'a Problem,
    rules: &'a MoveConstraints<'a>,
    /// Badness of every triangle, and the largest among triangles with a free vertex.
    badness: Vec<f64>,
    worst: f64,
    has_moved: Vec<bool>,
    done: u32,
}

impl<'a> Passes<'a> {
    /// Prepares the passes for a mesh with its vertices at `positions`.
    pub(crate) async fn new(
        problem: &'a Problem,
        rules: &'a MoveConstraints<'a>,
        positions: &[DVec2],
    ) -> Self {
        let badness = all(problem, rules.badness, positions).await;
        let worst = worst_of(problem, &badness).await;
        let has_moved = vec![false; problem.free_count()];
        Self { problem, rules, badness, worst, has_moved, done: 0 }
    }

    /// Does a pass. Returns whether another pass may improve more.
    pub(crate) async fn next(&mut self, positions: &mut [DVec2]) -> bool {
        let Self { problem, rules, badness, worst, has_moved, done } = self;
        let all = problem.corners().all();
        let count = (all.len() / SHARE).clamp(FEWEST, MAX_WORST);
        let bad = worst_triangles(problem, badness, count).await;
        let here = &*positions;
        let corners = bad.iter().flat_map(|&t| all[t as usize]);
        let regions = around(problem, corners, RINGS);
        let improved = paced::map_futures(regions, |vertices| async {
            Region::new(problem, rules, here, vertices).improve().await
        })
        .await;
        let moves: Vec<(u32, DVec2)> = improved.into_iter().flatten().flatten().collect();
        let from: Vec<DVec2> = moves.iter().map(|&(v, _)| positions[v as usize]).collect();
        moves.iter().for_each(|&(v, to)| positions[v as usize] = to);
        *badness = self::all(problem, rules.badness, positions).await;
        let last = std::mem::replace(worst, worst_of(problem, badness).await);
        let least = MIN_KEPT[usize::from(*done > 0)];
        let is_kept = *worst < last * (1.0 - least);
        if !is_kept {
            moves.iter().zip(from).for_each(|(&(v, _), from)| positions[v as usize] = from);
            return false;
        }
        for (&(v, to), from) in moves.iter().zip(from) {
            has_moved[v as usize] |= from != to;
        }
        *done += 1;
        *worst < last * (1.0 - MIN_GAIN) && *done < PASSES
    }

    /// Returns the number of vertices that the passes have moved.
    pub(crate) fn moved(&self) -> usize {
        self.has_moved.iter().filter(|moved| **moved).count()
    }
}

/// Returns the `count` worst triangles with a free vertex, in any order, and fewer if the mesh has fewer.
async fn worst_triangles(problem: &Problem, badness: &[f64], count: usize) -> Vec<u32> {
    let worst = |mut triangles: Vec<u32>| {
        let worse_first = |a: &u32, b: &u32| {
            let [x, y] = [a, b].map(|&t| badness[t as usize]);
            y.total_cmp(&x).then(a.cmp(b))
        };
        if triangles.len() > count {
            triangles.select_nth_unstable_by(count, worse_first);
            triangles.truncate(count);
        }
        triangles
    };
    // The worst triangles of the mesh are among the worst of each part.
    let can_move = |&t: &u32| problem.can_move(&problem.corners().all()[t as usize]);
    let of_parts = paced::map_ranges(badness.len(), SORTED, |part| {
        worst((part.start as u32..part.end as u32).filter(can_move).collect())
    });
    worst(of_parts.await.concat())
}
