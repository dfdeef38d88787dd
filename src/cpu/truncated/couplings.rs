//! The first level's matrix, to which each triangle adds.

use std::collections::BTreeMap;
use std::ops::Range;

use super::blocks::{Block, Blocks, split};
use super::matrix::{Matrix, ROWS, Square, transposed};
use super::scalar::Scalar;
use crate::parallel::paced;
use crate::run::multilevel::NONE;
use crate::run::truncated::aggregation::Pattern;

/// The places at which triangles add to the first level's matrix. Triangles add to the upper blocks, on and above the diagonal.
/// The blocks below the diagonal are copies.
pub(super) struct Couplings {
    /// Aggregate of each vertex, in the order of [`Blocks::order`].
    group_of: Vec<u32>,
    /// Index of the first upper block of each row, and at the end the number of upper blocks.
    first: Vec<u32>,
    /// For each block of the matrix, twice the index of the upper block of which it is a copy, plus 1 for a transposed copy.
    sources: Vec<u32>,
}

/// The sums over the triangles of a block of vertices in upper blocks of the matrix.
pub(super) struct Entries<'a, T> {
    couplings: &'a Couplings,
    pattern: &'a Pattern,
    /// The upper blocks in the rows of the block's own aggregates.
    own: &'a mut [Square<T>],
    /// Index of the first of them.
    start: usize,
    beyond: Beyond<T>,
}

/// The sums over the triangles of a block of vertices in rows of other blocks, by the index of the upper block.
pub(super) type Beyond<T> = BTreeMap<u32, Square<T>>;

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

    /// Returns the pairs of aggregates whose blocks of the matrix the triangle changes, as indices of [`Self::groups`]. Triangles
    /// inside one aggregate have none.
    pub(super) fn pairs(&self) -> &'static [[usize; 2]] {
        const ONE: &[[usize; 2]] = &[[0, 0]];
        const TWO: &[[usize; 2]] = &[[0, 0], [1, 1], [0, 1]];
        const THREE: &[[usize; 2]] = &[[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]];
        match if self.is_inside { 0 } else { self.count } {
            0 => &[],
            1 => ONE,
            2 => TWO,
            _ => THREE,
        }
    }
}

impl Couplings {
    pub(super) async fn new(blocks: &Blocks, pattern: &Pattern) -> Self {
        let mut group_of = vec![0; blocks.order.len()];
        for (group, ends) in (0..).zip(blocks.group_start.windows(2)) {
            group_of[ends[0] as usize..ends[1] as usize].fill(group);
        }
        let mut first = vec![0];
        for (row, diagonal) in pattern.diagonal.iter().enumerate() {
            first.push(first[row] + pattern.start[row + 1] - diagonal);
        }
        let mut sources = vec![0; pattern.columns.len()];
        let rows = pattern.rows();
        let lengths = (0..rows).step_by(ROWS).map(|row| {
            let end = pattern.start[rows.min(row + ROWS)];
            (end - pattern.start[row]) as usize
        });
        let parts: Vec<_> = split(&mut sources, lengths).collect();
        paced::for_each_part(parts, |task, sources| {
            let rows = task * ROWS..rows.min(task * ROWS + ROWS);
            let places =
                rows.flat_map(|row| pattern.columns(row).iter().map(move |&to| (row as u32, to)));
            for (source, (row, column)) in sources.iter_mut().zip(places) {
                let index = upper_index(&first, pattern, row.min(column), row.max(column));
                *source = 2 * index + u32::from(column < row);
            }
        })
        .await;
        Self { group_of, first, sources }
    }

    /// Returns the aggregate of each vertex of a block's local list, [`NONE`] for fixed vertices.
    pub(super) fn groups(&self, block: &Block) -> Vec<u32> {
        let mut groups = self.group_of[block.own.clone()].to_vec();
        groups.extend(block.others.iter().map(|&v| self.group_of[v as usize]));
        groups.resize(block.vertices.len(), NONE);
        groups
    }

    /// Returns the range of the upper blocks in the rows of a block's aggregates.
    pub(super) fn own(&self, block: &Block) -> Range<usize> {
        self.first[block.groups.start] as usize..self.first[block.groups.end] as usize
    }

    /// Returns the upper blocks, all zero.
    pub(super) fn upper<T: Scalar>(&self) -> Vec<Square<T>> {
        vec![Square::default(); self.first.last().map_or(0, |&count| count as usize)]
    }

    /// Returns the sums of a block before its first triangle. `own` has the upper blocks in the rows of its aggregates.
    pub(super) fn entries<'a, T: Scalar>(
        &'a self,
        pattern: &'a Pattern,
        block: &Block,
        own: &'a mut [Square<T>],
    ) -> Entries<'a, T> {
        let start = self.own(block).start;
        Entries { couplings: self, pattern, own, start, beyond: Beyond::new() }
    }

    /// Adds the sums of all blocks in rows of other blocks to the upper blocks of the matrix, in the order of the blocks.
    pub(super) fn add_beyond<T: Scalar>(sums: Vec<Beyond<T>>, upper: &mut [Square<T>]) {
        let mut places = vec![NONE; upper.len()];
        let mut all: Vec<(u32, Square<T>)> = Vec::new();
        for (index, entry) in sums.into_iter().flatten() {
            let place = &mut places[index as usize];
            if *place == NONE {
                *place = all.len() as u32;
                all.push((index, Square::default()));
            }
            let sum = &mut all[*place as usize].1;
            sum.iter_mut().zip(entry).for_each(|(sum, entry)| *sum += entry);
        }
        for (index, sum) in all {
            let own = upper[index as usize].iter_mut();
            own.zip(sum).for_each(|(own, sum)| *own += sum);
        }
    }

    /// Sets the blocks of the matrix, given its upper blocks.
    pub(super) async fn complete<T: Scalar>(&self, upper: &[Square<T>], matrix: &mut Matrix<T>) {
        matrix.blocks = paced::collect(self.sources.len(), |at| {
            let source = self.sources[at];
            let block = &upper[(source / 2) as usize];
            if source % 2 == 1 { transposed(block) } else { *block }
        })
        .await;
    }
}

/// Returns the index of the upper block of a row and a column not before it. `first` has the index of the first upper block
/// of each row.
#[inline(always)]
fn upper_index(first: &[u32], pattern: &Pattern, row: u32, column: u32) -> u32 {
    let at = row as usize;
    if row == column {
        return first[at];
    }
    let columns = &pattern.columns[pattern.diagonal[at] as usize..pattern.row(at).end];
    first[at] + columns.partition_point(|&other| other < column) as u32
}

impl<T: Scalar> Entries<'_, T> {
    /// Returns the sum in the upper block of a row and a column not before it.
    #[inline(always)]
    pub(super) fn at(&mut self, row: u32, column: u32) -> &mut Square<T> {
        let index = upper_index(&self.couplings.first, self.pattern, row, column);
        match self.own.get_mut((index as usize).wrapping_sub(self.start)) {
            Some(own) => own,
            None => self.beyond.entry(index).or_default(),
        }
    }

    /// Returns the sums in rows of other blocks.
    pub(super) fn into_beyond(self) -> Beyond<T> {
        self.beyond
    }
}
