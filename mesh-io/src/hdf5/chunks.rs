//! The grid of a dataset's chunks: the items of each chunk, and its byte range in the file.

use super::btree::Tree;
use super::bytes::Hdf5Error;
use super::checksum::Checksum;
use super::entry::{Chunk, Entry};
use super::file_bytes::FileBytes;
use super::filters::Filter;
use super::fixed_array::{self, FixedArrayElement};
use super::layout::Index;

/// The division of a dataset into a grid of chunks. A compact or contiguous dataset counts as one chunk.
#[derive(Clone, Debug)]
pub(super) struct ChunkGrid {
    /// Shape of the dataset: its number of items in each dimension; `[1]` for a dataspace without dimensions.
    shape: Vec<usize>,
    /// Shape of a chunk: its number of items in each dimension.
    lengths: Vec<usize>,
    /// Size of an item in bytes.
    item: usize,
    /// Number of chunks in each dimension.
    counts: Vec<usize>,
    /// Number of chunks in each dimension of the largest shape to which the dataset may grow.
    max_counts: Vec<usize>,
}

impl ChunkGrid {
    /// Makes the grid of a dataset of `shape`, which may grow to `most` items in each dimension. A chunk has `lengths`
    /// items in each dimension, and an item has `item` bytes. `None` if a size in bytes or the number of chunks exceeds
    /// `usize`.
    pub(super) fn new(
        shape: &[u64],
        most: &[u64],
        lengths: &[u64],
        item: usize,
    ) -> Option<ChunkGrid> {
        let sizes = |numbers: &[u64]| {
            numbers.iter().map(|&n| usize::try_from(n).ok()).collect::<Option<Vec<usize>>>()
        };
        let (mut shape, mut lengths) = (sizes(shape)?, sizes(lengths)?);
        let mut most: Vec<usize> =
            most.iter().map(|&n| usize::try_from(n).unwrap_or(usize::MAX)).collect();
        if shape.is_empty() {
            (shape, lengths, most) = (vec![1], vec![1], vec![1]);
        }
        let counts: Vec<usize> = shape.iter().zip(&lengths).map(|(n, l)| n.div_ceil(*l)).collect();
        let max_counts: Vec<usize> =
            most.iter().zip(&lengths).map(|(n, l)| n.div_ceil(*l)).collect();
        let grid = ChunkGrid { shape, lengths, item, counts, max_counts };
        let product =
            |of: &[usize]| of.iter().try_fold(item.max(1), |all: usize, &n| all.checked_mul(n));
        // The sizes of dataset and chunk and the number of chunks must fit in a `usize`.
        product(&grid.shape)?;
        product(&grid.lengths)?;
        product(&grid.counts)?;
        Some(grid)
    }

    /// Returns the size of all items in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.shape.iter().product::<usize>() * self.item
    }

    /// Returns the size of a chunk before filtering, in bytes. Chunks at the edge of the dataset have the full size
    /// too.
    pub(super) fn chunk_bytes(&self) -> usize {
        self.lengths.iter().product::<usize>() * self.item
    }

    /// Returns the number of chunks.
    pub(super) fn count(&self) -> usize {
        self.counts.iter().product()
    }

    /// Returns the number of the chunk whose first item has the indices `first`; `None` if no chunk starts there.
    fn number_of(&self, first: impl Iterator<Item = usize>) -> Option<usize> {
        let mut each = first.zip(&self.lengths).zip(&self.counts);
        each.try_fold(0, |number: usize, ((at, length), count)| {
            let place = at / length;
            (at % length == 0 && place < *count).then(|| number * count + place)
        })
    }

    /// Returns the position of a chunk in an index with room for all chunks of the largest shape; `None` above
    /// `usize::MAX`.
    fn index_position(&self, number: usize) -> Option<usize> {
        let places = self.position(number);
        places
            .iter()
            .zip(&self.max_counts)
            .try_fold(0, |all: usize, (place, room)| all.checked_mul(*room)?.checked_add(*place))
    }

    /// Returns the number of chunks of the largest shape; `usize::MAX` if the dataset may grow without limit.
    pub(super) fn max_count(&self) -> usize {
        self.max_counts
            .iter()
            .try_fold(1, |all: usize, &n| all.checked_mul(n))
            .unwrap_or(usize::MAX)
    }

    fn position(&self, number: usize) -> Vec<usize> {
        let mut left = number;
        let mut places = vec![0; self.counts.len()];
        for (place, count) in places.iter_mut().zip(&self.counts).rev() {
            (*place, left) = (left % count, left / count);
        }
        places
    }

    /// Calls `take` for each run of bytes that is contiguous both in the dataset and in the chunk, with three values in
    /// bytes: offset in the dataset, offset in the chunk, and length.
    pub(super) fn runs(&self, number: usize, mut take: impl FnMut(usize, usize, usize)) {
        let rank = self.shape.len();
        // In dimensions after `last` the chunk spans the dataset, so items with equal indices up to `last` are
        // contiguous.
        let whole = |d: &usize| self.lengths[*d] == self.shape[*d];
        let last = rank - 1 - (1..rank).rev().take_while(whole).count();
        let inner = self.shape[last + 1..].iter().product::<usize>() * self.item;
        let starts: Vec<usize> =
            self.position(number).iter().zip(&self.lengths).map(|(p, l)| p * l).collect();
        let extents: Vec<usize> =
            (0..rank).map(|d| self.lengths[d].min(self.shape[d] - starts[d])).collect();
        let mut at = vec![0; last];
        loop {
            let (mut outer, mut own) = (0, 0);
            for d in 0..last {
                outer = outer * self.shape[d] + starts[d] + at[d];
                own = own * self.lengths[d] + at[d];
            }
            outer = outer * self.shape[last] + starts[last];
            own *= self.lengths[last];
            take(outer * inner, own * inner, extents[last] * inner);
            // The next run: the last index that can grow is incremented, and later indices restart at 0.
            let Some(d) = (0..last).rev().find(|&d| at[d] + 1 < extents[d]) else { break };
            at[d] += 1;
            at[d + 1..].fill(0);
        }
    }

    /// Returns all chunks of an index, in the order of their numbers. `at` is the offset of the dataset's header.
    ///
    /// # Errors
    /// If the index is damaged, if a chunk is missing or listed twice, or if the chunks do not fit in the file.
    pub(super) fn chunks(
        &self,
        raw: &FileBytes<'_>,
        index: &Index,
        address: usize,
        filters: &[Filter],
        sum: Option<&Checksum>,
        at: usize,
    ) -> Result<Vec<Chunk>, Hdf5Error> {
        let damaged = || Hdf5Error::damaged(at, "a dataset of the HDF5 file");
        let whole = self.chunk_bytes();
        let mut chunks = Vec::new();
        match index {
            Index::Tree => {
                Tree::of_chunks(raw, self.shape.len()).each(
                    address,
                    &mut |mut key, address, place| {
                        let size = key.at()..key.at() + 4;
                        let length = key.count(4)?;
                        let mask = key.number(4)? as u32;
                        let mut first = Vec::with_capacity(self.shape.len());
                        for _ in &self.shape {
                            first.push(key.count(8)?);
                        }
                        // Entries outside of the grid are leftovers of a dataset that was larger.
                        if let Some(number) = self.number_of(first.into_iter()) {
                            let entry = Some(Entry { address: place, size: Some(size), sum: None });
                            let range = address..address.saturating_add(length);
                            chunks.push(Chunk { number, range, mask, entry });
                        }
                        Ok(())
                    },
                )?;
            }
            Index::Single { stored, place } => {
                let (length, mask, size) = match stored.clone() {
                    Some((length, mask, size)) => (length, mask, Some(size)),
                    None => (whole, 0, None),
                };
                let range = address..address.saturating_add(length);
                let entry = Some(Entry { address: *place, size, sum: sum.cloned() });
                chunks.push(Chunk { number: 0, range, mask, entry });
            }
            Index::Implicit => {
                for number in 0..self.count().min(raw.bytes.len()) {
                    let before =
                        self.index_position(number).and_then(|room| room.checked_mul(whole));
                    let start = address.saturating_add(before.ok_or_else(damaged)?);
                    let range = start..start.saturating_add(whole);
                    chunks.push(Chunk { number, range, mask: 0, entry: None });
                }
            }
            Index::FixedArray => {
                let max_count = self.max_count();
                let slots = fixed_array::read(raw, address, max_count, !filters.is_empty())?;
                for number in 0..self.count().min(slots.count()) {
                    let room = self.index_position(number).ok_or_else(damaged)?;
                    if let Some(FixedArrayElement { address, length, mask, entry }) =
                        slots.slot(raw, room)?
                    {
                        let range = address..address.saturating_add(length.unwrap_or(whole));
                        chunks.push(Chunk { number, range, mask, entry: Some(entry) });
                    }
                }
            }
        }
        chunks.sort_by_key(|chunk| chunk.number);
        let numbers = chunks.iter().map(|chunk| chunk.number);
        if !numbers.eq(0..self.count()) {
            let problem = "a dataset with chunks that are missing or written twice";
            return Err(Hdf5Error::unread(at, problem));
        }
        self.check(raw, &chunks, filters).ok_or_else(damaged)?;
        Ok(chunks)
    }

    /// Returns `None` if a chunk ends beyond the file, if an unfiltered chunk has a wrong size, or if all chunks
    /// together are longer than the file.
    fn check(&self, raw: &FileBytes<'_>, chunks: &[Chunk], filters: &[Filter]) -> Option<()> {
        let mut left = raw.bytes.len();
        for chunk in chunks {
            let is_inside = chunk.range.end <= raw.bytes.len();
            let fits = !filters.is_empty() || chunk.range.len() == self.chunk_bytes();
            left = left.checked_sub(chunk.range.len()).filter(|_| is_inside && fits)?;
        }
        Some(())
    }
}
