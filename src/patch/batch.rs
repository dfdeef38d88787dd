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
