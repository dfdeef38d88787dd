//! Aggregates: groups of unknowns of one level, each of which becomes a single unknown of the next coarser level.

use std::ops::Range;

use crate::parallel::paced;

/// Largest number of unknowns between two pauses.
const UNKNOWNS: usize = 1 << 13;

/// Marks an unknown that belongs to no aggregate.
pub(crate) const NONE: u32 = u32::MAX;

/// Disjoint groups of neighboring unknowns.
#[derive(Clone, Debug, Default)]
pub(crate) struct Aggregates {
    /// Aggregate of each unknown, [`NONE`] for unknowns without neighbors.
    pub(crate) of: Vec<u32>,
    /// Number of aggregates.
    pub(crate) count: usize,
}

impl Aggregates {
    /// Joins each unknown and all its neighbors to a new aggregate, in the order of the unknowns. Unknowns with a
    /// neighbor in an earlier aggregate are left over. Each unknown left over then joins the aggregate of a neighbor
    /// (Vaněk, Mandel & Brezina, Computing 56, 1996). On a triangulation, an aggregate has eight or nine members.
    pub(crate) async fn new<N: Iterator<Item = u32>>(
        unknowns: usize,
        neighbors: impl Fn(usize) -> N + Sync + Send,
    ) -> Self {
        let mut of = vec![NONE; unknowns];
        let mut count = 0;
        paced::in_order(unknowns, UNKNOWNS, |roots| {
            for root in roots {
                if of[root] != NONE || neighbors(root).any(|k| of[k as usize] != NONE) {
                    continue;
                }
                let mut alone = true;
                for k in neighbors(root) {
                    of[k as usize] = count;
                    alone = false;
                }
                if !alone {
                    of[root] = count;
                    count += 1;
                }
            }
        })
        .await;
        // An unknown left over has no neighbors, or has a neighbor in an aggregate of the first pass.
        let first_pass = of.clone();
        paced::for_each_chunk(&mut of, UNKNOWNS, |first, groups| {
            for (k, group) in (first..).zip(groups).filter(|(_, group)| **group == NONE) {
                let near = neighbors(k).map(|n| first_pass[n as usize]).find(|&g| g != NONE);
                *group = near.unwrap_or(NONE);
            }
        })
        .await;
        Self { of, count: count as usize }
    }

    /// Adds each unknown without an aggregate to the first aggregate among its neighbors.
    pub(crate) async fn with_the_rest<N: Iterator<Item = u32>>(
        mut self,
        neighbors: impl Fn(usize) -> N + Sync + Send,
    ) -> Self {
        let Self { of, .. } = &mut self;
        paced::in_order(of.len(), UNKNOWNS, |unknowns| {
            for k in unknowns {
                if of[k] == NONE {
                    let near = neighbors(k).map(|n| of[n as usize]).find(|&group| group != NONE);
                    of[k] = near.unwrap_or(NONE);
                }
            }
        })
        .await;
        self
    }

    /// Puts each unknown without an aggregate into a new aggregate.
    pub(crate) fn add_lone(&mut self) {
        for group in self.of.iter_mut().filter(|group| **group == NONE) {
            *group = self.count as u32;
            self.count += 1;
        }
    }

    /// Returns the members of all aggregates as compressed rows. The first list has the offset of each aggregate in the
    /// second list, followed by the length of the second list.
    pub(crate) async fn members(&self) -> (Vec<u32>, Vec<u32>) {
        let grouped = |unknowns: Range<usize>| unknowns.filter(|&k| self.of[k] != NONE);
        let mut start = vec![0u32; self.count + 1];
        paced::in_order(self.of.len(), 8 * UNKNOWNS, |unknowns| {
            grouped(unknowns).for_each(|k| start[self.of[k] as usize + 1] += 1);
        })
        .await;
        for group in 0..self.count {
            start[group + 1] += start[group];
        }
        let mut next = start.clone();
        let mut members = vec![0; start[self.count] as usize];
        paced::in_order(self.of.len(), UNKNOWNS, |unknowns| {
            for k in grouped(unknowns) {
                let next = &mut next[self.of[k] as usize];
                members[*next as usize] = k as u32;
                *next += 1;
            }
        })
        .await;
        (start, members)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::pace::now;

    fn path(unknowns: usize) -> Aggregates {
        let neighbors = |k: usize| {
            let (before, after) = (k.checked_sub(1), Some(k + 1).filter(|&n| n < unknowns));
            before.into_iter().chain(after).map(|n| n as u32)
        };
        now(Aggregates::new(unknowns, neighbors))
    }

    #[test]
    fn every_vertex_with_a_neighbor_is_in_an_aggregate() {
        let groups = path(11);
        assert!(groups.of.iter().all(|&g| (g as usize) < groups.count));
        let (start, members) = now(groups.members());
        assert_eq!((start.len(), members.len()), (groups.count + 1, 11));
        for group in 0..groups.count {
            let inside = &members[start[group] as usize..start[group + 1] as usize];
            assert!(inside.len() >= 2);
            assert!(inside.iter().all(|&k| groups.of[k as usize] as usize == group));
        }
    }

    #[test]
    fn a_left_over_vertex_joins_the_aggregate_of_a_neighbor() {
        // A path of four unknowns, and an unknown that is no neighbor of the others.
        let neighbors = |k: usize| {
            let (before, after) = (k.checked_sub(1), Some(k + 1).filter(|&n| n < 4));
            before.into_iter().chain(after).filter(move |_| k < 4).map(|n| n as u32)
        };
        let groups = now(Aggregates::new(5, neighbors));
        assert_eq!(groups.of[4], NONE);
        let count = groups.count;
        let all = now(groups.with_the_rest(|_| [4, 3, 0].into_iter()));
        assert_eq!((all.count, all.of[4]), (count, all.of[3]));
        assert!((all.of[4] as usize) < count);
    }

    #[test]
    fn a_vertex_without_neighbors_is_in_no_aggregate_or_alone_in_one() {
        let mut groups = path(1);
        assert_eq!((&groups.of[..], groups.count), (&[NONE][..], 0));
        groups.add_lone();
        assert_eq!((groups.of, groups.count), (vec![0], 1));
    }
}
