//! Lookup of vertex indices by node ids, which are arbitrary numbers in the file.

use std::cell::OnceCell;
use std::collections::HashMap;

/// Map from the ids of the nodes of a file to the 0-based indices of the vertices.
pub(crate) enum IdIndex {
    /// Consecutive ids from `first` on, as in most files.
    Run { first: u64, count: u64 },
    /// Ids with few gaps: the index for each id from `first` on, and [`ABSENT`] in the gaps.
    Dense { first: u64, indices: Vec<u32> },
    /// Ids with wide gaps.
    Sparse(HashMap<u64, u32>),
}

/// Entry of a dense map for an id without a vertex. All indices are smaller, as a mesh has at most `u32::MAX` vertices.
const ABSENT: u32 = u32::MAX;

impl IdIndex {
    /// Maps each id to its 0-based position in `ids`, which holds at most `u32::MAX` ids. If ids are repeated, the
    /// error is the position of the first id that repeats an earlier id.
    pub(crate) fn new(ids: &[u64]) -> Result<IdIndex, usize> {
        let first = ids.iter().copied().min().unwrap_or(0);
        let last = ids.iter().copied().max().unwrap_or(0);
        let count = ids.len() as u64;
        if ids.iter().enumerate().all(|(position, &id)| id - first == position as u64) {
            return Ok(IdIndex::Run { first, count });
        }
        // The table has at most four entries per id, which bounds its memory for any ids.
        if last - first < 4 * count {
            let mut indices = vec![ABSENT; (last - first) as usize + 1];
            for (position, &id) in ids.iter().enumerate() {
                let index = &mut indices[(id - first) as usize];
                if *index != ABSENT {
                    return Err(position);
                }
                *index = position as u32;
            }
            return Ok(IdIndex::Dense { first, indices });
        }
        let mut map = HashMap::with_capacity(ids.len());
        for (position, &id) in ids.iter().enumerate() {
            if map.insert(id, position as u32).is_some() {
                return Err(position);
            }
        }
        Ok(IdIndex::Sparse(map))
    }

    #[inline]
    pub(crate) fn index(&self, id: u64) -> Option<u32> {
        match self {
            IdIndex::Run { first, count } => {
                id.checked_sub(*first).filter(|index| index < count).map(|index| index as u32)
            }
            IdIndex::Dense { first, indices } => {
                let slot = usize::try_from(id.checked_sub(*first)?).ok()?;
                indices.get(slot).copied().filter(|&index| index != ABSENT)
            }
            IdIndex::Sparse(map) => map.get(&id).copied(),
        }
    }
}

/// Ids of the nodes of a file, in file order. Consecutive ids are stored as first id and count, other ids as a list.
#[derive(Default)]
pub(crate) struct IdList {
    first: u64,
    count: u64,
    /// All ids in file order; empty while the ids are consecutive.
    list: Vec<u64>,
    /// Announced number of ids, for which the list reserves memory.
    expected: usize,
}

impl IdList {
    pub(crate) fn expect(&mut self, more: usize) {
        self.expected = self.count as usize + more;
    }

    #[inline]
    pub(crate) fn push(&mut self, id: u64) {
        self.extend(id, 1);
    }

    /// Appends `count` consecutive ids from `first` on.
    #[inline]
    pub(crate) fn extend(&mut self, first: u64, count: u64) {
        if self.count == 0 {
            self.first = first;
        } else if !self.list.is_empty() || first.checked_sub(self.first) != Some(self.count) {
            self.extend_list(first, count);
        }
        self.count += count;
    }

    #[inline(never)]
    fn extend_list(&mut self, first: u64, count: u64) {
        if self.list.is_empty() {
            self.list.reserve_exact(self.expected.max((self.count + count) as usize));
            self.list.extend((0..self.count).map(|position| self.first + position));
        }
        self.list.extend((0..count).map(|position| first + position));
    }

    /// Returns the id at a 0-based position in file order.
    pub(crate) fn of(&self, position: usize) -> u64 {
        match self.list.is_empty() {
            true => self.first + position as u64,
            false => self.list[position],
        }
    }

    /// Maps the ids to their positions, with the error of [`IdIndex::new`].
    pub(crate) fn map(&self) -> Result<IdIndex, usize> {
        match self.list.is_empty() {
            true => Ok(IdIndex::Run { first: self.first, count: self.count }),
            false => IdIndex::new(&self.list),
        }
    }
}

/// Builder of an [`IdIndex`]: collects node ids in file order, and builds the map in [`finish`](Self::finish) or at the
/// first lookup.
#[derive(Default)]
pub(crate) struct IdIndexBuilder {
    list: IdList,
    map: OnceCell<IdIndex>,
}

impl IdIndexBuilder {
    /// Returns the list of ids. Ids pushed after the first call of [`finish`](Self::finish) or [`index`](Self::index)
    /// are missing from the map.
    pub(crate) fn list(&mut self) -> &mut IdList {
        &mut self.list
    }

    #[inline]
    pub(crate) fn push(&mut self, id: u64) {
        self.list.push(id);
    }

    /// Returns the number of ids.
    pub(crate) fn len(&self) -> usize {
        self.list.count as usize
    }

    /// Builds the map from all ids, and drops the list. If ids are repeated, the error holds the first repeated id and
    /// the position of its second node.
    pub(crate) fn finish(&mut self) -> Result<&IdIndex, (u64, usize)> {
        let map = self.list.map().map_err(|second| (self.list.of(second), second))?;
        self.list.list = Vec::new();
        Ok(self.map.get_or_init(|| map))
    }

    /// Returns the map; `None` before [`finish`](Self::finish) or the first lookup.
    pub(crate) fn map(&self) -> Option<&IdIndex> {
        self.map.get()
    }

    /// Returns the 0-based index of the node with an id; the first call builds the map. If the file repeats an id, no
    /// node is found at all. Files with repeated ids are refused when they are first read.
    #[inline]
    pub(crate) fn index(&self, id: u64) -> Option<u32> {
        match self.map.get() {
            Some(map) => map.index(id),
            None => self.map_now().index(id),
        }
    }

    #[cold]
    fn map_now(&self) -> &IdIndex {
        let none = IdIndex::Run { first: 0, count: 0 };
        self.map.get_or_init(|| self.list.map().unwrap_or(none))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_finds_its_tags_and_no_others() {
        let kinds: [&[u64]; 6] = [
            &[],
            &[5, 6, 7],
            &[9, 4, 6],
            &[1, u64::MAX, 0],
            &[u64::MAX],
            &[u64::MAX - 1, u64::MAX],
        ];
        for ids in kinds {
            let map = IdIndex::new(ids).unwrap();
            for (position, &id) in ids.iter().enumerate() {
                assert_eq!(map.index(id), Some(position as u32), "{ids:?}");
            }
            for absent in [2, 3, 8, 10, 1 << 40] {
                assert_eq!(map.index(absent), None, "{ids:?}");
            }
        }
    }

    #[test]
    fn found_tags_are_those_that_were_added() {
        type Run = (u64, u64);
        let cases: [(&[Run], bool); 5] = [
            (&[], true),
            (&[(5, 1), (6, 1), (7, 4), (11, 1)], true),
            (&[(u64::MAX - 1, 2), (0, 1)], false),
            (&[(5, 3), (7, 1), (8, 2)], false),
            (&[(5, 1), (5, 1)], false),
        ];
        for (runs, is_run) in cases {
            let mut found = IdList::default();
            runs.iter().for_each(|&(first, count)| found.extend(first, count));
            let expected: Vec<u64> = runs
                .iter()
                .flat_map(|&(first, count)| (0..count).map(move |n| first + n))
                .collect();
            let all: Vec<u64> = (0..expected.len()).map(|position| found.of(position)).collect();
            assert_eq!(all, expected, "{runs:?}");
            assert_eq!(found.list.is_empty(), is_run, "{runs:?}");
            match (found.map(), IdIndex::new(&expected)) {
                (Ok(map), Ok(other)) => {
                    let of = |map: &IdIndex| [0, 5, 6, 7, 12, u64::MAX].map(|id| map.index(id));
                    assert_eq!(of(&map), of(&other), "{runs:?}");
                }
                (found, expected) => assert_eq!(found.err(), expected.err(), "{runs:?}"),
            }
        }
    }

    #[test]
    fn a_repeated_tag_is_refused_by_its_second_position() {
        assert_eq!(IdIndex::new(&[5, 5]).err(), Some(1));
        assert_eq!(IdIndex::new(&[3, 1, 2, 1]).err(), Some(3));
        assert_eq!(IdIndex::new(&[1, 1 << 50, 1 << 50]).err(), Some(2));
    }
}
