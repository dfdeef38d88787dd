//! A counting sort on all cores: numbers grouped by keys, in compressed rows.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use rayon::prelude::*;

use crate::parallel::tasks::{collect, for_each, for_each_part, map_parts};

/// Upper limit of parts counted in parallel. Memory grows with the parts, as each has a counter per group.
const MAX_PARTS: usize = 8;

/// Items per part, at most one part with fewer. Fewer items are not worth another thread.
const SMALL: usize = 1 << 14;

/// Numbers in groups, ascending within each group.
#[derive(Clone, Debug)]
pub(crate) struct Groups {
    start: Vec<u32>,
    items: Vec<u32>,
}

impl Groups {
    /// Groups the numbers below `items`. Number `i` is put into the `N` groups `keys(i)`, each below `groups`.
    pub(crate) fn new<const N: usize>(
        items: usize,
        groups: usize,
        keys: impl Fn(usize) -> [u32; N] + Sync,
    ) -> Self {
        Self::of_keys(items, items * N, groups, keys)
    }

    /// Groups the numbers below `items`. Number `i` is put into the groups `keys(i)`, each below `groups`. `total` is the
    /// number of all keys.
    pub(crate) fn of_keys<K: IntoIterator<Item = u32>>(
        items: usize,
        total: usize,
        groups: usize,
        keys: impl Fn(usize) -> K + Sync,
    ) -> Self {
        let grouped = atomics(total, 0);
        let put = |item: usize, at: usize| grouped[at].store(item as u32, Relaxed);
        let start = place(items, groups, keys, put);
        Self { start, items: plain(grouped) }
    }

    /// Returns the offset of each group in the grouped list, and behind these offsets the length of the list.
    pub(crate) fn starts(&self) -> &[u32] {
        &self.start
    }

    /// Returns the numbers in a group.
    pub(crate) fn of(&self, group: usize) -> &[u32] {
        &self.items[self.start[group] as usize..self.start[group + 1] as usize]
    }

    /// Splits the groups into chunks of `chunk` groups; the last may be shorter. Each chunk has the offsets of its
    /// groups in the whole list, the end of its last group, and its numbers.
    pub(crate) fn chunks_mut(&mut self, chunk: usize) -> Vec<(&[u32], &mut [u32])> {
        let Self { start, items } = self;
        let last = start.len() - 1;
        let bounds = (0..last).step_by(chunk).map(|first| &start[first..=last.min(first + chunk)]);
        let length = |bounds: &[u32]| (bounds[bounds.len() - 1] - bounds[0]) as usize;
        let parts = split(items, bounds.clone().map(length));
        bounds.zip(parts).collect()
    }

    /// Returns all numbers, group by group.
    pub(crate) fn into_items(self) -> Vec<u32> {
        self.items
    }
}

/// Groups the numbers below `items` by their keys without storing the groups. Calls `put(number, index)`, from any
/// thread, with each of a number's indices in the grouped list. Returns the offset of each group in this list, and
/// behind these offsets the length of the list.
pub(crate) fn place<K: IntoIterator<Item = u32>>(
    items: usize,
    groups: usize,
    keys: impl Fn(usize) -> K + Sync,
    put: impl Fn(usize, usize) + Sync,
) -> Vec<u32> {
    let parts = rayon::current_num_threads().min(MAX_PARTS).min(items.div_ceil(SMALL)).max(1);
    let part = |part: usize| part * items / parts..(part + 1) * items / parts;
    // The counters of a group, one for each part, are adjacent, so that their running sum is the index where each part
    // writes. No two parts share a counter. Counters are atomic only because the counters of one part are scattered in
    // memory.
    let mut next = atomics(groups * parts, 0);
    for_each(parts, &|p| {
        for key in part(p).flat_map(&keys) {
            let count = &next[key as usize * parts + p];
            count.store(count.load(Relaxed) + 1, Relaxed);
        }
    });
    let sum = running_sum(&mut next, AtomicU32::get_mut);
    let first = |group: usize| next.get(group * parts).map_or(sum, |count| count.load(Relaxed));
    let start = collect(groups + 1, first);
    for_each(parts, &|p| {
        for item in part(p) {
            for key in keys(item) {
                let next = &next[key as usize * parts + p];
                let at = next.load(Relaxed);
                next.store(at + 1, Relaxed);
                put(item, at as usize);
            }
        }
    });
    start
}

/// Splits a mutable slice into parts of the given lengths.
pub(crate) fn split<T>(mut slice: &mut [T], lengths: impl Iterator<Item = usize>) -> Vec<&mut [T]> {
    let take = |length| slice.split_off_mut(..length).unwrap_or_default();
    lengths.map(take).collect()
}

/// Replaces each cell's number by the sum of all earlier numbers, and returns the total.
pub(crate) fn running_sum<T: Send>(
    cells: &mut [T],
    number: impl Fn(&mut T) -> &mut u32 + Sync,
) -> u32 {
    const CHUNK: usize = 1 << 14;
    let sums = map_parts(cells.chunks_mut(CHUNK), |_, chunk| {
        chunk.iter_mut().map(|cell| *number(cell)).sum::<u32>()
    });
    let mut sum = 0;
    let before = sums.iter().map(|own| {
        sum += own;
        sum - own
    });
    let before: Vec<u32> = before.collect();
    for_each_part(cells.chunks_mut(CHUNK).zip(before), |_, (chunk, mut sum)| {
        for cell in chunk {
            let number = number(cell);
            sum += std::mem::replace(number, sum);
        }
    });
    sum
}

/// Makes a list of `count` equal numbers that several threads can overwrite.
pub(crate) fn atomics(count: usize, number: u32) -> Vec<AtomicU32> {
    (0..count).into_par_iter().map(|_| AtomicU32::new(number)).collect()
}

/// Returns the plain numbers of a list made by [`atomics`].
pub(crate) fn plain(atomics: Vec<AtomicU32>) -> Vec<u32> {
    atomics.into_iter().map(AtomicU32::into_inner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_those_of_a_plain_loop_whatever_the_threads() {
        // Enough for three parts; the last group stays empty.
        let keys = |item: usize| [item * item % 997, item % 131].map(|key| key as u32);
        let (items, groups) = (3 * SMALL, 998);
        let mut expected = vec![Vec::new(); groups];
        for item in 0..items {
            keys(item).iter().for_each(|&key| expected[key as usize].push(item as u32));
        }
        for threads in 1..=3 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut found = pool.install(|| Groups::new(items, groups, keys));
            for (group, expected) in expected.iter().enumerate() {
                assert_eq!(found.of(group), expected, "group {group}, {threads} threads");
            }
            let chunks = found.chunks_mut(100);
            assert_eq!(chunks.len(), 10);
            assert!(chunks.iter().all(|(bounds, chunk)| {
                chunk.len() as u32 == bounds[bounds.len() - 1] - bounds[0]
            }));
            assert_eq!(found.into_items(), expected.concat());
        }
    }

    #[test]
    fn running_sums_continue_across_chunks() {
        let mut cells: Vec<u32> = (0..50_000).map(|i| i % 7).collect();
        let plain: Vec<u32> =
            cells.iter().scan(0, |sum, &cell| Some(std::mem::replace(sum, *sum + cell))).collect();
        let last = cells[49_999];
        assert_eq!(running_sum(&mut cells, |cell| cell), plain[49_999] + last);
        assert_eq!(cells, plain);
        assert_eq!(running_sum(&mut [], |cell: &mut u32| cell), 0);
    }
}
