//! Finds the index of a vertex by the number its file gives it, its tag; tags are arbitrary numbers.

use std::collections::HashMap;

/// Finds the index of a tag.
pub(crate) enum TagMap {
    /// Consecutive tags, as most files have them.
    Run { first: u64, count: u64 },
    /// Tags with few gaps: the index of each tag from `first` on, [`ABSENT`] in the gaps.
    Dense { first: u64, indices: Vec<u32> },
    /// Tags far apart.
    Sparse(HashMap<u64, u32>),
}

/// Marks a tag without a vertex. Indices are less, as there are at most `u32::MAX` vertices.
const ABSENT: u32 = u32::MAX;

impl TagMap {
    /// Maps each tag to its position, of which there are at most `u32::MAX`. Fails with the
    /// position of the first tag that was there before.
    pub(crate) fn new(tags: &[u64]) -> Result<TagMap, usize> {
        let first = tags.iter().copied().min().unwrap_or(0);
        let last = tags.iter().copied().max().unwrap_or(0);
        let count = tags.len() as u64;
        if tags.iter().enumerate().all(|(position, &tag)| tag - first == position as u64) {
            return Ok(TagMap::Run { first, count });
        }
        // The table's size is bound to the number of tags, whatever their values.
        if last - first < 4 * count {
            let mut indices = vec![ABSENT; (last - first) as usize + 1];
            for (position, &tag) in tags.iter().enumerate() {
                let index = &mut indices[(tag - first) as usize];
                if *index != ABSENT {
                    return Err(position);
                }
                *index = position as u32;
            }
            return Ok(TagMap::Dense { first, indices });
        }
        let mut map = HashMap::with_capacity(tags.len());
        for (position, &tag) in tags.iter().enumerate() {
            if map.insert(tag, position as u32).is_some() {
                return Err(position);
            }
        }
        Ok(TagMap::Sparse(map))
    }

    #[inline]
    pub(crate) fn index(&self, tag: u64) -> Option<u32> {
        match self {
            TagMap::Run { first, count } => {
                tag.checked_sub(*first).filter(|index| index < count).map(|index| index as u32)
            }
            TagMap::Dense { first, indices } => {
                let slot = usize::try_from(tag.checked_sub(*first)?).ok()?;
                indices.get(slot).copied().filter(|&index| index != ABSENT)
            }
            TagMap::Sparse(map) => map.get(&tag).copied(),
        }
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
        for tags in kinds {
            let map = TagMap::new(tags).unwrap();
            for (position, &tag) in tags.iter().enumerate() {
                assert_eq!(map.index(tag), Some(position as u32), "{tags:?}");
            }
            for absent in [2, 3, 8, 10, 1 << 40] {
                assert_eq!(map.index(absent), None, "{tags:?}");
            }
        }
    }

    #[test]
    fn a_repeated_tag_is_refused_by_its_second_position() {
        assert_eq!(TagMap::new(&[5, 5]).err(), Some(1));
        assert_eq!(TagMap::new(&[3, 1, 2, 1]).err(), Some(3));
        assert_eq!(TagMap::new(&[1, 1 << 50, 1 << 50]).err(), Some(2));
    }
}
