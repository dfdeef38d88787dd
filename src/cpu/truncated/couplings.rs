//! The blocks of the first level's matrix to which each triangle adds.

use std::ops::Range;

use super::blocks::{Block, Blocks};
use super::matrix::{Matrix, ROWS, Square, transposed};
use super::scalar::Scalar;
use crate::parallel::paced;
use crate::run::multilevel::NONE;
use crate::run::truncated::aggregation::Pattern;

/// The entries of the first level's matrix to which the triangles of each block add, and where they go.
pub(super) struct Couplings {
    /// The couplings of each block.
    pub(super) blocks: Vec<BlockCouplings>,
    /// Place in `sources` of the first local entry of each block of the matrix.
    start: Vec<u32>,
    /// Indices of local entries of all blocks, block of the matrix by block.
    sources: Vec<u32>,
}

/// The entries of the matrix to which the triangles of one block add.
pub(super) struct BlockCouplings {
    /// The aggregate of each vertex of the local list, [`NONE`] for fixed vertices.
    pub(super) groups: Vec<u32>,
    /// The local entries of the triangles, in their order: for n aggregates in ascending order the n diagonal entries, and
    /// then those of the pairs. Triangles inside one aggregate have none.
    pub(super) places: Vec<u32>,
    /// Row and column of each local entry; the row is at most the column.
    keys: Vec<[u32; 2]>,
    /// Range of the local entries of the block among those of all blocks.
    pub(super) entries: Range<usize>,
}

/// The aggregates at the corners of a triangle.
pub(super) struct CornerGroups {
    /// The distinct aggregates, ascending. The first [`count`](Self::count) are valid.
    pub(super) groups: [u32; 3],
    pub(super) count: usize,
    /// Whether all corners are in one aggregate and no corner slides. The motion of a sliding corner is not that of its aggregate.
    pub(super) is_inside: bool,
}

impl CornerGroups {
    #[inline(always)]
    pub(super) fn new(of: [u32; 3], has_sliding_corner: bool) -> Self {
        let [mut a, mut b, mut c] = of;
        if b < a {
            (a, b) = (b, a);
        }
        if c < b {
            (b, c) = (c, b);
        }
        if b < a {
            (a, b) = (b, a);
        }
        let mut groups = [NONE; 3];
        let mut count = 0;
        for group in [a, b, c] {
            if group != NONE && (count == 0 || groups[count - 1] != group) {
                groups[count] = group;
                count += 1;
            }
        }
        Self { groups, count, is_inside: a == c && !has_sliding_corner }
    }

    /// Returns the number of entries to which the triangle adds.
    #[inline(always)]
    pub(super) fn entries(&self) -> usize {
        if self.is_inside { 0 } else { self.count * (self.count + 1) / 2 }
    }

    /// Returns the pairs of aggregates of the entries, as indices of [`Self::groups`].
    pub(super) fn pairs(&self) -> &'static [[usize; 2]] {
        const ONE: &[[usize; 2]] = &[[0, 0]];
        const TWO: &[[usize; 2]] = &[[0, 0], [1, 1], [0, 1]];
        const THREE: &[[usize; 2]] = &[[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]];
        match self.entries() {
            0 => &[],
            1 => ONE,
            3 => TWO,
            _ => THREE,
        }
    }
}

impl Couplings {
    /// Returns the couplings of a mesh, and the pattern of the first level's matrix.
    pub(super) async fn new(blocks: &Blocks) -> (Self, Pattern) {
        let mut group_of = vec![0; blocks.order.len()];
        for (group, ends) in (0..).zip(blocks.group_start.windows(2)) {
            group_of[ends[0] as usize..ends[1] as usize].fill(group);
        }
        let of = |_, block: &Block| BlockCouplings::new(block, &group_of);
        let mut made = paced::map_parts(&blocks.blocks, of).await;
        let mut first = 0;
        for block in &mut made {
            block.entries = first..first + block.keys.len();
            first = block.entries.end;
        }
        let keys: Vec<[u32; 2]> =
            made.iter_mut().flat_map(|block| std::mem::take(&mut block.keys)).collect();
        let rows = sorted_by_row(&keys, blocks.groups());
        let mut couplings = Self { blocks: made, start: vec![0], sources: Vec::new() };
        let columns = rows.into_iter().zip(0..).map(|(mut row, group)| {
            row.sort_unstable();
            let mut columns: Vec<u32> = Vec::with_capacity(row.len());
            for [column, source] in row {
                if columns.last() != Some(&column) {
                    if !columns.is_empty() {
                        couplings.start.push(couplings.sources.len() as u32);
                    }
                    columns.push(column);
                }
                if source != NONE {
                    couplings.sources.push(source);
                }
            }
            couplings.start.push(couplings.sources.len() as u32);
            debug_assert!(columns.contains(&group));
            columns
        });
        let pattern = Pattern::of_rows(columns);
        (couplings, pattern)
    }

    /// Returns the number of local entries of all blocks.
    pub(super) fn entries(&self) -> usize {
        self.blocks.last().map_or(0, |block| block.entries.end)
    }

    /// Sets the blocks of the matrix to the sums of the local entries.
    pub(super) async fn add_up<T: Scalar>(&self, local: &[Square<T>], matrix: &mut Matrix<T>) {
        let Matrix { pattern, blocks, .. } = matrix;
        let rows = pattern.rows();
        let lengths = (0..rows).step_by(ROWS).map(|row| {
            let end = pattern.start[rows.min(row + ROWS)];
            (end - pattern.start[row]) as usize
        });
        let parts: Vec<_> = super::blocks::split(blocks, lengths).collect();
        paced::for_each_part(parts, |task, mut blocks| {
            for row in task * ROWS..rows.min(task * ROWS + ROWS) {
                let places = pattern.row(row);
                let (of_row, rest) = std::mem::take(&mut blocks).split_at_mut(places.len());
                blocks = rest;
                for (block, at) in of_row.iter_mut().zip(places) {
                    let sources = self.start[at] as usize..self.start[at + 1] as usize;
                    *block = Square::default();
                    for &source in &self.sources[sources] {
                        for (sum, &entry) in block.iter_mut().zip(&local[source as usize]) {
                            *sum += entry;
                        }
                    }
                    if (pattern.columns[at] as usize) < row {
                        *block = transposed(block);
                    }
                }
            }
        })
        .await;
    }
}

/// Returns the columns and local entries of each row, in both triangles of the matrix, and the diagonal of each row with
/// [`NONE`] for its local entry.
fn sorted_by_row(keys: &[[u32; 2]], rows: usize) -> Vec<Vec<[u32; 2]>> {
    let mut lists: Vec<Vec<[u32; 2]>> = (0..rows as u32).map(|row| vec![[row, NONE]]).collect();
    for (source, &[row, column]) in (0..).zip(keys) {
        lists[row as usize].push([column, source]);
        if row != column {
            lists[column as usize].push([row, source]);
        }
    }
    lists
}

impl BlockCouplings {
    fn new(block: &Block, group_of: &[u32]) -> Self {
        let mut groups = group_of[block.own.clone()].to_vec();
        groups.extend(block.others.iter().map(|&v| group_of[v as usize]));
        let mut beyond = groups[block.own.len()..].to_vec();
        beyond.sort_unstable();
        beyond.dedup();
        groups.resize(block.vertices.len(), NONE);
        // Index of an aggregate among those of the block, followed by those of other blocks.
        let row_of = |group: u32| match (group as usize).wrapping_sub(block.groups.start) {
            own if own < block.groups.len() => own,
            _ => block.groups.len() + beyond.partition_point(|&other| other < group),
        };
        let (mut keys, mut places) = (Vec::new(), Vec::with_capacity(2 * block.triangles.len()));
        // Columns of each row, ascending, with the places of their entries.
        let mut rows: Vec<Vec<[u32; 2]>> = vec![Vec::new(); block.groups.len() + beyond.len()];
        for t in &block.triangles {
            let corners = t.map(|v| groups[v as usize]);
            let of = CornerGroups::new(corners, block.has_sliding_corner(t));
            for &[row, column] in of.pairs() {
                let [row, column] = [of.groups[row], of.groups[column]];
                let entries = &mut rows[row_of(row)];
                let at = entries.partition_point(|[other, _]| *other < column);
                if entries.get(at).is_none_or(|[other, _]| *other != column) {
                    entries.insert(at, [column, keys.len() as u32]);
                    keys.push([row, column]);
                }
                places.push(entries[at][1]);
            }
        }
        Self { groups, places, keys, entries: 0..0 }
    }
}
