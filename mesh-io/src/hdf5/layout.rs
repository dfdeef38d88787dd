//! Layout messages: whether a dataset is compact, contiguous or chunked, and the index of its chunks.

use super::bytes::{ByteReader, Hdf5Error};
use std::ops::Range;

/// Location of a dataset's items according to its layout message.
#[derive(Clone, Debug)]
pub(super) enum Layout {
    /// In the object header, in this range of the file.
    Compact(Range<usize>),
    /// In one piece from this address on; `None` if the items were never written.
    Contiguous(Option<usize>),
    /// In chunks of `lengths` items in each dimension. `address` is the offset of the index, or for `Single` and
    /// `Implicit` the offset of the first chunk; `None` if no chunk was written.
    Chunked { lengths: Vec<u64>, index: Index, address: Option<usize> },
}

/// Kind of index from chunk numbers to chunk addresses.
#[derive(Clone, Debug)]
pub(super) enum Index {
    /// B-tree of version 1, whose keys hold the size, the filter mask and the first item of each chunk.
    Tree,
    /// A single chunk. `stored` is present if filters apply: the chunk's size in bytes, the mask of skipped filters,
    /// and the range of the file with the size. `place` is the offset of the chunk's address.
    Single { stored: Option<(usize, u32, Range<usize>)>, place: usize },
    /// No index: the chunks of the largest shape follow each other in the order of their numbers.
    Implicit,
    /// Fixed array, with an entry for each chunk of the largest shape.
    FixedArray,
}

impl Layout {
    /// Reads a layout message of a dataset with `rank` dimensions.
    pub(super) fn read(mut bytes: ByteReader<'_>, rank: usize) -> Result<Layout, Hdf5Error> {
        match bytes.byte()? {
            1 | 2 => Self::first(bytes, rank),
            3 => Self::third(bytes, rank),
            4 | 5 => Self::fourth(bytes, rank),
            version => Err(bytes.unread(format!("a dataset with a layout of version {version}"))),
        }
    }

    fn first(mut bytes: ByteReader<'_>, rank: usize) -> Result<Layout, Hdf5Error> {
        let dimensions = usize::from(bytes.byte()?);
        let class = bytes.byte()?;
        bytes.skip(5)?;
        let address = if class == 0 { None } else { bytes.address()? };
        let mut lengths = Self::lengths(&mut bytes, dimensions, 4)?;
        match class {
            0 => {
                let size = bytes.count(4)?;
                Self::compact(bytes, size)
            }
            1 => Ok(Layout::Contiguous(address)),
            2 => {
                // The last length is the size of an item in bytes.
                lengths.pop();
                Self::chunked(&bytes, lengths, rank, Index::Tree, address)
            }
            _ => Err(Self::other(&bytes, class)),
        }
    }

    fn third(mut bytes: ByteReader<'_>, rank: usize) -> Result<Layout, Hdf5Error> {
        match bytes.byte()? {
            0 => {
                let size = bytes.count(2)?;
                Self::compact(bytes, size)
            }
            1 => Ok(Layout::Contiguous(bytes.address()?)),
            2 => {
                let dimensions = usize::from(bytes.byte()?);
                let address = bytes.address()?;
                let mut lengths = Self::lengths(&mut bytes, dimensions, 4)?;
                lengths.pop();
                Self::chunked(&bytes, lengths, rank, Index::Tree, address)
            }
            class => Err(Self::other(&bytes, class)),
        }
    }

    fn fourth(mut bytes: ByteReader<'_>, rank: usize) -> Result<Layout, Hdf5Error> {
        let mut own = bytes.clone();
        match own.byte()? {
            2 => {}
            _ => return Self::third(bytes, rank),
        }
        bytes.byte()?;
        let flags = bytes.byte()?;
        let dimensions = usize::from(bytes.byte()?);
        let width = bytes.count(1)?;
        if !(1..=8).contains(&width) {
            return Err(bytes.damaged());
        }
        let mut lengths = Self::lengths(&mut bytes, dimensions, width)?;
        lengths.pop();
        if flags & 1 != 0 {
            return Err(bytes.unread("a dataset whose chunks at the edge are not compressed"));
        }
        let kind = bytes.byte()?;
        let mut stored = None;
        match kind {
            1 if flags & 2 != 0 => {
                let start = bytes.at();
                let size = bytes.length()?;
                let place = start..bytes.at();
                stored = Some((size, bytes.number(4)? as u32, place));
            }
            1 | 2 => {}
            3 => bytes.skip(1)?,
            _ => {
                let name = match kind {
                    4 => "an extensible array",
                    5 => "a tree of version 2",
                    _ => "an unknown index",
                };
                let problem = format!("a dataset that may grow, with {name} of its chunks");
                return Err(bytes.unread(problem));
            }
        }
        let place = bytes.at();
        let address = bytes.address()?;
        let index = match kind {
            1 => Index::Single { stored, place },
            2 => Index::Implicit,
            _ => Index::FixedArray,
        };
        Self::chunked(&bytes, lengths, rank, index, address)
    }

    fn lengths(
        bytes: &mut ByteReader<'_>,
        count: usize,
        width: usize,
    ) -> Result<Vec<u64>, Hdf5Error> {
        (0..count).map(|_| bytes.number(width)).collect()
    }

    fn compact(mut bytes: ByteReader<'_>, size: usize) -> Result<Layout, Hdf5Error> {
        let start = bytes.at();
        bytes.skip(size)?;
        Ok(Layout::Compact(start..bytes.at()))
    }

    fn chunked(
        bytes: &ByteReader<'_>,
        lengths: Vec<u64>,
        rank: usize,
        index: Index,
        address: Option<usize>,
    ) -> Result<Layout, Hdf5Error> {
        match lengths.len() == rank && rank > 0 && !lengths.contains(&0) {
            true => Ok(Layout::Chunked { lengths, index, address }),
            false => Err(bytes.damaged()),
        }
    }

    #[cold]
    fn other(bytes: &ByteReader<'_>, class: u8) -> Hdf5Error {
        match class {
            3 => bytes.unread("a virtual dataset, composed of datasets of other files"),
            _ => bytes.damaged(),
        }
    }
}
