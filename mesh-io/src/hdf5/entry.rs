//! Chunks of a dataset, with the locations of their addresses and sizes in the metadata of the file.

use super::checksum::Checksum;
use std::ops::Range;

/// The stored bytes of one chunk, with the location of its index entry.
#[derive(Clone, Debug)]
pub(super) struct Chunk {
    /// Number of the chunk in the grid of the dataset, counted from 0. The last dimension varies fastest.
    pub(super) number: usize,
    /// Range of the file with the stored bytes, after all filters.
    pub(super) range: Range<usize>,
    /// Filters that were skipped for the chunk: bit n stands for filter n of the dataset.
    pub(super) mask: u32,
    /// The index entry. `None` if the chunk never moves: the index is implicit, or the dataset is compact or
    /// contiguous.
    pub(super) entry: Option<Entry>,
}

/// Location of the address and the size of a chunk in the metadata of the file.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// Offset of the address field in the file.
    pub(super) address: usize,
    /// Range of the size field. `None` if the index stores no sizes, as the dataset has no filters.
    pub(super) size: Option<Range<usize>>,
    /// Checksum that covers both fields, if their block of metadata has one.
    pub(super) sum: Option<Checksum>,
}
