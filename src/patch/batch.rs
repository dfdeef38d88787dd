//! Batches of vertices that visits take at once, one vertex in each lane.

use crate::layout::Problem;
use crate::patch::lanes::LANES;

/// Four free vertices with equally many neighbors. Lanes beyond the last vertex of a batch repeat the last vertex.
pub(crate) type VertexBatch = [u32; LANES];

/// Returns vertices in batches, in the given order. Consecutive vertices of equal degree form the batches.
pub(crate) fn batches(problem: &Problem, vertices: impl Iterator<Item = u32>) -> Vec<VertexBatch> {
    let vertices: Vec<u32> = vertices.collect();
    let alike = vertices.chunk_by(|&v, &k| problem.ring_of(v).len() == problem.ring_of(k).len());
    let batches = alike.flat_map(|alike| alike.chunks(LANES));
    batches.map(|batch| std::array::from_fn(|lane| batch[lane.min(batch.len() - 1)])).collect()
}

/// Returns up to four vertices of equal degree, from `first` on, and their number. At most `most` vertices, at least one,
/// are left to visit. Lanes without a vertex of their own repeat the last vertex.
#[inline(always)]
pub(crate) fn batch_at(problem: &Problem, first: usize, most: usize) -> (VertexBatch, usize) {
    let v = first as u32;
    let degree = problem.ring_of(v).len();
    let most = LANES.min(most) as u32;
    let mut count = 1;
    while count < most && problem.ring_of(v + count).len() == degree {
        count += 1;
    }
    let last = v + count - 1;
    ([v, last.min(v + 1), last.min(v + 2), last.min(v + 3)], count as usize)
}
