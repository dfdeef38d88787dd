//! Batches of vertices that visits take at once, one vertex in each lane.

use crate::layout::{OPPOSITE, Problem};
use crate::patch::lanes::{LANES, Width};
use crate::patch::numbers::Numbers;

/// Up to four free vertices with equally many neighbors, and elements of equal kinds in equal order. Lanes beyond the last vertex of a
/// batch repeat the last vertex.
pub(crate) type VertexBatch = [u32; LANES];

/// Returns vertices in batches, in the given order. Consecutive vertices with alike elements form the batches.
pub(crate) fn batches(problem: &Problem, vertices: impl Iterator<Item = u32>) -> Vec<VertexBatch> {
    let vertices: Vec<u32> = vertices.collect();
    let alike =
        vertices.chunk_by(|&v, &k| are_alike::<true>(problem.ring_of(v), problem.ring_of(k)));
    let batches = alike.flat_map(|alike| alike.chunks(LANES));
    batches.map(|batch| std::array::from_fn(|lane| batch[lane.min(batch.len() - 1)])).collect()
}

/// Returns as many vertices with alike elements, from `first` on, as a visit takes at once, and their number. At most `most` vertices, at least one,
/// are left to visit. Lanes without a vertex of their own repeat the last vertex. `MIXED` tells whether the mesh has quadrilaterals.
#[inline(always)]
pub(crate) fn batch_at<W: Width, const MIXED: bool>(
    problem: &Problem,
    first: usize,
    most: usize,
) -> (VertexBatch, usize) {
    let v = first as u32;
    let ring = problem.ring_of(v);
    let most = W::Numbers::LANES.min(most) as u32;
    let mut count = 1;
    while count < most && are_alike::<MIXED>(ring, problem.ring_of(v + count)) {
        count += 1;
    }
    let last = v + count - 1;
    ([v, last.min(v + 1), last.min(v + 2), last.min(v + 3)], count as usize)
}

/// Returns whether two free vertices with these lists in [`Problem::ring`] have equally many neighbors, and elements of equal
/// kinds in the order of the lists. Without `MIXED`, all elements are triangles.
#[inline(always)]
fn are_alike<const MIXED: bool>(ring: &[u32], other: &[u32]) -> bool {
    let has_equal_marks = || ring.iter().zip(other).all(|(&a, &b)| (a ^ b) & OPPOSITE == 0);
    ring.len() == other.len() && (!MIXED || has_equal_marks())
}
