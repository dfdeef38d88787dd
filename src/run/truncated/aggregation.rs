//! The connectivity of the coarser levels of Newton steps: aggregates of vertices, and aggregates of aggregates.

use crate::parallel::paced;
use crate::run::multilevel::{Aggregates, NONE};

/// Largest product of the numbers of neighbors of two members that may share an aggregate as neighbors. A hub with all
/// its neighbors would be an aggregate of unlike vertices.
const MOST_DEGREES: usize = 144;
/// Factor on the correction of a coarser level. Plain aggregates are too stiff, as their members move alike. In a prototype,
/// factors from 1.5 to 2.2 changed the time of a run by 4 % at most.
pub(crate) const STIFFNESS: f64 = 1.8;
/// Number of unknowns of an aggregate: a translation, and a turn with a scaling as a complex number.
pub(crate) const UNKNOWNS: usize = 4;
/// Share of its diagonal entry that a pivot of a block must exceed in single precision. A smaller pivot is rounding of the sums.
pub(crate) const LEAST_PIVOT: f64 = 1e-6;
/// Share of the unknowns that a level must leave out to repay its work.
const LEAST_SHRINKAGE: f64 = 0.3;

/// The factors of two steps of Chebyshev's method for the eigenvalues from 0.6 to 2.4: the factor of the first step by the
/// residual, then of the first step and of the remaining residual in the sum of both steps. A matrix is a sum of semidefinite
/// matrices of three blocks each, so the eigenvalues of D⁻¹A are at most 3, and the polynomial stays below 1 up to there.
pub(crate) const CHEBYSHEV: [f64; 3] = {
    let [low, high] = [0.6, 2.4];
    let (middle, half) = (0.5 * (high + low), 0.5 * (high - low));
    let ratio = 1.0 / (2.0 * middle / half - half / middle);
    [1.0 / middle, 1.0 + ratio * half / middle, 2.0 * ratio / half]
};

/// Number of rows that one task lists.
const ROWS: usize = 1 << 10;

/// The places of the blocks of a matrix, each row in ascending order of columns.
#[derive(Default)]
pub(crate) struct Pattern {
    pub(crate) start: Vec<u32>,
    pub(crate) columns: Vec<u32>,
    /// Place of the diagonal block of each row.
    pub(crate) diagonal: Vec<u32>,
}

impl Pattern {
    /// Makes the pattern of `count` rows on all threads. `list` lists the columns of a row in ascending order. Every row must
    /// have its diagonal.
    async fn of_rows(count: usize, list: impl Fn(usize, &mut Vec<u32>) + Sync + Send) -> Self {
        let parts = paced::map_ranges(count, ROWS, |rows| {
            let mut part = Self::default();
            let mut columns = Vec::new();
            for row in rows {
                columns.clear();
                list(row, &mut columns);
                let before = columns.partition_point(|&column| column < row as u32);
                part.diagonal.push((part.columns.len() + before) as u32);
                part.columns.extend_from_slice(&columns);
                part.start.push(part.columns.len() as u32);
            }
            part
        })
        .await;
        let mut pattern = Self { start: vec![0], ..Self::default() };
        pattern.start.reserve_exact(count);
        pattern.diagonal.reserve_exact(count);
        pattern.columns.reserve_exact(parts.iter().map(|part| part.columns.len()).sum());
        for part in parts {
            let first = pattern.columns.len() as u32;
            pattern.start.extend(part.start.iter().map(|end| first + end));
            pattern.diagonal.extend(part.diagonal.iter().map(|place| first + place));
            pattern.columns.extend(part.columns);
        }
        pattern
    }

    pub(crate) fn rows(&self) -> usize {
        self.diagonal.len()
    }

    /// Returns the places of the blocks of a row.
    #[inline(always)]
    pub(crate) fn row(&self, row: usize) -> std::ops::Range<usize> {
        self.start[row] as usize..self.start[row + 1] as usize
    }

    /// Returns the columns of a row, with its diagonal.
    pub(crate) fn columns(&self, row: usize) -> &[u32] {
        &self.columns[self.row(row)]
    }

    /// Joins the rows to aggregates of neighbors. Returns the aggregates, and the pattern of their matrix. `None` if there are at
    /// most `least` rows, or hardly fewer aggregates.
    pub(crate) async fn joined(&self, least: usize) -> Option<(Members, Self)> {
        let rows = self.rows();
        if rows <= least {
            return None;
        }
        let neighbors = |row: usize| {
            self.columns(row).iter().copied().filter(move |&other| other as usize != row)
        };
        let degree = |row: usize| self.columns(row).len() - 1;
        let members = Members::new(rows, degree, neighbors).await;
        if members.count() as f64 > (1.0 - LEAST_SHRINKAGE) * rows as f64 {
            return None;
        }
        let pattern = members.pattern(|row| self.columns(row as usize).iter().copied()).await;
        Some((members, pattern))
    }
}

/// The members of aggregates. Each vertex, or aggregate of the finer level, is a member of one.
pub(crate) struct Members {
    /// The aggregate of each member.
    pub(crate) group: Vec<u32>,
    /// Index in `members` of the first member of each aggregate, and at the end the number of members.
    pub(crate) start: Vec<u32>,
    pub(crate) members: Vec<u32>,
}

impl Members {
    /// Joins `count` members to aggregates of neighbors. `neighbors` lists the neighbors of a member, with [`NONE`] for those that
    /// are no members, and `degree` returns the number of neighbors. Members without an aggregate become aggregates.
    pub(crate) async fn new<N: Iterator<Item = u32>>(
        count: usize,
        degree: impl Fn(usize) -> usize + Copy + Sync,
        neighbors: impl Fn(usize) -> N + Sync,
    ) -> Self {
        // Most meshes have no hub, and the degree of each neighbor would be looked up four times.
        let most = (0..count).map(degree).max().unwrap_or(0);
        let has_hubs = most * most > MOST_DEGREES;
        let near = |member: usize| {
            neighbors(member).filter(move |&other| {
                other != NONE
                    && (!has_hubs || degree(member) * degree(other as usize) <= MOST_DEGREES)
            })
        };
        let mut aggregates = Aggregates::new(count, near).await;
        aggregates.add_lone();
        let (start, members) = aggregates.members().await;
        Self { group: aggregates.of, start, members }
    }

    pub(crate) fn count(&self) -> usize {
        self.start.len() - 1
    }

    /// Returns the members of an aggregate.
    pub(crate) fn of(&self, aggregate: usize) -> &[u32] {
        &self.members[self.start[aggregate] as usize..self.start[aggregate + 1] as usize]
    }

    /// Returns the pattern of the aggregates' matrix. `neighbors` lists the neighbors of a member; numbers beyond all members
    /// have no aggregate.
    pub(crate) async fn pattern<N: Iterator<Item = u32>>(
        &self,
        neighbors: impl Fn(u32) -> N + Sync + Send,
    ) -> Pattern {
        Pattern::of_rows(self.count(), |aggregate, columns| {
            let near = self.of(aggregate).iter().flat_map(|&member| neighbors(member));
            columns.push(aggregate as u32);
            for column in near.filter_map(|member| self.group.get(member as usize).copied()) {
                // Most neighbors are in the aggregate itself, or in that of the neighbor before.
                if column != columns[0] && columns.last() != Some(&column) {
                    columns.push(column);
                }
            }
            columns.sort_unstable();
            columns.dedup();
        })
        .await
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::pace::now;

    /// The pattern of a path.
    fn path(rows: u32) -> Pattern {
        let near = |row: u32| row.saturating_sub(1)..rows.min(row + 2);
        now(Pattern::of_rows(rows as usize, |row, columns| columns.extend(near(row as u32))))
    }

    #[test]
    fn aggregates_of_a_path_form_a_path() {
        let (members, joined) = now(path(40).joined(1)).unwrap();
        assert_eq!((members.count(), joined.rows()), (14, 14));
        let all: usize = (0..members.count()).map(|aggregate| members.of(aggregate).len()).sum();
        assert_eq!(all, 40);
        for row in 0..joined.rows() {
            let near = row.saturating_sub(1) as u32..(row as u32 + 2).min(14);
            assert!(joined.columns(row).iter().copied().eq(near), "{:?}", joined.columns(row));
            assert_eq!(joined.columns[joined.diagonal[row] as usize], row as u32);
        }
    }

    #[test]
    fn few_rows_are_not_joined() {
        assert!(now(path(12).joined(12)).is_none());
        assert!(now(path(13).joined(12)).is_some());
        assert!(now(path(1).joined(1)).is_none());
    }

    #[test]
    fn rows_without_neighbors_are_not_joined() {
        let alone = now(Pattern::of_rows(40, |row, columns| columns.push(row as u32)));
        assert!(now(alone.joined(1)).is_none());
    }
}
