//! Where a chunk of a dataset stands, and where the file says so.

use super::checksum::Checksum;
use std::ops::Range;

/// Where a chunk stands, and where the file says so.
#[derive(Clone, Debug)]
pub(super) struct Chunk {
    /// Its place among all chunks of the dataset, the last dimension first.
    pub(super) number: usize,
    /// The bytes of it in the file.
    pub(super) range: Range<usize>,
    /// The filters that were left out.
    pub(super) mask: u32,
    /// None where its place follows from that of others, or is the only one.
    pub(super) entry: Option<Entry>,
}

/// Where an index has the place of a chunk.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// Where its address starts.
    pub(super) address: usize,
    /// Where its size stands, if that is told.
    pub(super) size: Option<Range<usize>>,
    /// The checksum that covers these.
    pub(super) sum: Option<Checksum>,
}
