//! The vertices that move and their corners in blocks, from the connectivity alone.
//!
//! Vertices are numbered aggregate by aggregate, and a block has the vertices of successive aggregates. A corner belongs
//! to the block of its first vertex that moves. Its other vertices may belong to other blocks, so each block has a local list of
//! vertices. The list has own vertices first, then vertices of other blocks, then fixed vertices. One task forms the sums over
//! the corners of a block, in a local list, and copies those at vertices of other blocks to a shared list. The other blocks
//! then add them to their own sums in a fixed order. So the sums have equal bits on any number of threads.

use std::ops::Range;

use crate::layout::Problem;
use crate::parallel::counting_sort::Groups;
use crate::parallel::paced;
use crate::run::multilevel::NONE;
use crate::run::truncated::aggregation::{Members, Pattern};
use crate::slide::Movers;
use crate::topology::Corners;

/// Number of vertices from which on a block ends. The vectors of a block then fit the first cache of a processor.
const VERTICES: u32 = 2048;

/// The blocks of a mesh.
pub(super) struct Blocks {
    /// Index in the problem of each vertex that moves, aggregate by aggregate.
    pub(super) order: Vec<u32>,
    /// Index in the order of each free vertex of the problem.
    pub(super) rank: Vec<u32>,
    /// Index of the first vertex of each aggregate, and the number of vertices at the end.
    pub(super) group_start: Vec<u32>,
    /// Index in the order of each sliding vertex.
    pub(super) slides_at: Vec<u32>,
    pub(super) blocks: Vec<Block>,
}

/// For each vertex of a problem, its index in [`Blocks::order`].
struct Ranks<'a> {
    movers: &'a Movers<'a>,
    rank: Vec<u32>,
}

impl Ranks<'_> {
    /// Returns the place of a vertex, [`NONE`] for a fixed vertex.
    fn of(&self, vertex: u32) -> u32 {
        self.rank.get(self.movers.of(vertex) as usize).copied().unwrap_or(NONE)
    }
}

/// Vertices and corners that one task handles.
pub(super) struct Block {
    /// The own vertices, in the order of [`Blocks::order`].
    pub(super) own: Range<usize>,
    /// The aggregates of the own vertices.
    pub(super) groups: Range<usize>,
    /// The local list of vertices: index in the problem of the own vertices, of those of other blocks, and of fixed ones.
    pub(super) vertices: Vec<u32>,
    /// Index of each vertex of other blocks in the order of [`Blocks::order`].
    pub(super) others: Vec<u32>,
    /// For each vertex of the local list, the index among the sliding vertices, or [`NONE`]. Empty if no vertex of the list
    /// slides.
    pub(super) slides: Vec<u32>,
    /// The vertices of each corner, counter-clockwise, as indices of the local list: triangles, then corners of quadrilaterals.
    pub(super) corners: Vec<[u32; 3]>,
    /// Number of triangles.
    pub(super) triangles: usize,
    /// The sums that other blocks form at own vertices, sorted by own vertex.
    pub(super) received: Vec<Received>,
    /// Range of the shared list, with an entry for each vertex of another block in the local list.
    pub(super) shared: Range<usize>,
}

/// A sum that another block has formed at an own vertex of a block.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Received {
    /// Index among the own vertices of the block.
    to: u32,
    /// Index in the shared list.
    from: u32,
}

impl Blocks {
    /// Divides a mesh. Returns its blocks, and the pattern of the first level's matrix.
    pub(super) async fn new(problem: &Problem, movers: &Movers<'_>) -> (Self, Pattern) {
        let count = movers.count();
        let (members, pattern) = movers.joined().await;
        let Members { start: group_start, members: mut order, .. } = members;
        let mut rank = vec![NONE; count];
        for (new, &mover) in (0..).zip(&order) {
            rank[mover as usize] = new;
        }
        let slides_at = rank[count - movers.sliding()..].to_vec();
        order.iter_mut().for_each(|mover| *mover = movers.vertex(*mover));
        let ranks = Ranks { movers, rank };
        let ranges = ranges(&group_start);
        let mut block_of = Vec::with_capacity(count);
        for (block, (own, _)) in (0..).zip(&ranges) {
            block_of.extend(own.clone().map(|_| block));
        }
        let lists = corners_of_blocks(problem, &ranks, &block_of, ranges.len()).await;
        let corners = problem.corners();
        let made = paced::map_parts(ranges, |at, (own, groups)| {
            Block::new(own, groups, &order, &ranks, corners, lists.of(at))
        });
        let mut blocks = made.await;
        share(&mut blocks, &block_of);
        let Ranks { mut rank, .. } = ranks;
        rank.truncate(problem.free_count());
        (Self { order, rank, group_start, slides_at, blocks }, pattern)
    }

    /// Returns a shared list of zeros: a sum for each vertex of another block in the local list of a block.
    pub(super) fn shared<X: Copy + Default, const N: usize>(&self) -> Vec<[X; N]> {
        vec![[X::default(); N]; self.blocks.last().map_or(0, |block| block.shared.end)]
    }

    /// Splits a list over the vertices at the ends of the blocks.
    pub(super) fn split<'a, X>(&'a self, list: &'a mut [X]) -> impl Iterator<Item = &'a mut [X]> {
        split(list, self.blocks.iter().map(|block| block.own.len()))
    }

    /// Splits a shared list at the ends of the blocks.
    pub(super) fn split_shared<'a, X>(
        &'a self,
        list: &'a mut [X],
    ) -> impl Iterator<Item = &'a mut [X]> {
        split(list, self.blocks.iter().map(|block| block.others.len()))
    }

    /// Splits a list over the aggregates at the ends of the blocks.
    pub(super) fn split_groups<'a, X>(
        &'a self,
        list: &'a mut [X],
    ) -> impl Iterator<Item = &'a mut [X]> {
        split(list, self.blocks.iter().map(|block| block.groups.len()))
    }
}

/// Splits a list into parts of the given lengths, which must not exceed the list.
pub(super) fn split<X>(
    mut list: &mut [X],
    lengths: impl Iterator<Item = usize>,
) -> impl Iterator<Item = &mut [X]> {
    lengths.map(move |length| {
        let (part, rest) = std::mem::take(&mut list).split_at_mut(length);
        list = rest;
        part
    })
}

/// Returns the vertices and the aggregates of each block.
fn ranges(group_start: &[u32]) -> Vec<(Range<usize>, Range<usize>)> {
    let (mut ranges, mut first) = (Vec::new(), 0);
    for group in 1..group_start.len() {
        let (from, to) = (group_start[first], group_start[group]);
        if to - from >= VERTICES || group + 1 == group_start.len() {
            ranges.push((from as usize..to as usize, first..group));
            first = group;
        }
    }
    ranges
}

/// Returns the corners of each block with a vertex that moves, and behind these corners those without such a vertex: triangles,
/// then corners of quadrilaterals.
async fn corners_of_blocks(
    problem: &Problem,
    ranks: &Ranks<'_>,
    block_of: &[u32],
    count: usize,
) -> Groups {
    let all = problem.corners().all();
    let blocks = paced::collect(all.len(), |corner| {
        let [a, b, c] = all[corner].map(|v| ranks.of(v));
        block_of.get(a.min(b).min(c) as usize).copied().unwrap_or(count as u32)
    })
    .await;
    Groups::new(all.len(), count + 1, |corner| [blocks[corner]])
}

impl Block {
    fn new(
        own: Range<usize>,
        groups: Range<usize>,
        order: &[u32],
        ranks: &Ranks<'_>,
        all: &Corners<'_>,
        list: &[u32],
    ) -> Self {
        let triangles = list.partition_point(|&corner| all.is_triangle(corner));
        let mut corners: Vec<[u32; 3]> =
            list.iter().map(|&corner| all.all()[corner as usize]).collect();
        // A vertex that moves has its rank as its key, and a fixed vertex a number above all ranks.
        let (free, sliding) = (ranks.rank.len() as u32, ranks.movers.sliding() as u32);
        let key = |v: u32| match ranks.of(v) {
            NONE => v + sliding,
            rank => rank,
        };
        let is_own = |key: u32| own.contains(&(key as usize));
        let keys = corners.as_flattened().iter().map(|&v| key(v));
        let mut beyond: Vec<u32> = keys.filter(|&key| !is_own(key)).collect();
        beyond.sort_unstable();
        beyond.dedup();
        let others = beyond[..beyond.partition_point(|&key| key < free)].to_vec();
        for v in corners.as_flattened_mut() {
            let key = key(*v);
            *v = match is_own(key) {
                true => key - own.start as u32,
                false => (own.len() + beyond.partition_point(|&k| k < key)) as u32,
            };
        }
        let mut vertices = order[own.clone()].to_vec();
        let vertex = |&key: &u32| order.get(key as usize).copied().unwrap_or_else(|| key - sliding);
        vertices.extend(beyond.iter().map(vertex));
        let slide = |&v: &u32| ranks.movers.slide(v);
        let mut slides: Vec<u32> = Vec::new();
        if sliding > 0 && vertices.iter().any(|v| slide(v) != NONE) {
            slides.extend(vertices.iter().map(slide));
        }
        let (received, shared) = (Vec::new(), 0..0);
        Self { own, groups, vertices, others, slides, corners, triangles, received, shared }
    }

    /// Returns the index among the sliding vertices of a vertex of the local list, [`NONE`] if the vertex does not slide.
    #[inline(always)]
    pub(super) fn slide(&self, vertex: u32) -> u32 {
        self.slides.get(vertex as usize).copied().unwrap_or(NONE)
    }

    /// Returns whether a corner of a triangle slides.
    #[inline(always)]
    pub(super) fn has_sliding_corner(&self, triangle: &[u32; 3]) -> bool {
        !self.slides.is_empty() && triangle.iter().any(|&v| self.slide(v) != NONE)
    }

    /// Returns the vertices of other blocks in the local list.
    pub(super) fn foreign(&self) -> Range<usize> {
        self.own.len()..self.own.len() + self.others.len()
    }

    /// Returns the own vertices at which other blocks have sums, and these sums.
    pub(super) fn received(&self) -> impl Iterator<Item = (usize, &[Received])> {
        self.received.chunk_by(|a, b| a.to == b.to).map(|sums| (sums[0].to as usize, sums))
    }
}

/// Adds the sums that other blocks have formed at an own vertex of a block to the own sum.
#[inline(always)]
pub(super) fn receive<X: Copy + std::ops::AddAssign, const N: usize>(
    own: &mut [X; N],
    received: &[Received],
    shared: &[[X; N]],
) {
    for of_other in received {
        for (own, sum) in own.iter_mut().zip(&shared[of_other.from as usize]) {
            *own += *sum;
        }
    }
}

/// Lists the sums that each block receives from others.
fn share(blocks: &mut [Block], block_of: &[u32]) {
    let mut start = 0;
    for at in 0..blocks.len() {
        let others = std::mem::take(&mut blocks[at].others);
        for (from, &vertex) in (start as u32..).zip(&others) {
            let owner = &mut blocks[block_of[vertex as usize] as usize];
            owner.received.push(Received { to: vertex - owner.own.start as u32, from });
        }
        blocks[at].shared = start..start + others.len();
        start += others.len();
        blocks[at].others = others;
    }
    for block in blocks {
        block.received.sort_unstable();
        block.received.shrink_to_fit();
    }
}
