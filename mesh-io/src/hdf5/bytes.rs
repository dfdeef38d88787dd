//! Reader of the metadata of an HDF5 file, and the errors of damaged or unsupported metadata.

use crate::binary::byte_order::ByteOrder;
use std::ops::Range;

/// Damage or an unsupported feature of a part of an HDF5 file.
#[derive(Clone, Debug)]
pub(crate) struct Hdf5Error {
    /// Offset of the damaged or unsupported part in the file.
    pub(crate) at: usize,
    pub(crate) problem: String,
    pub(crate) remedy: &'static str,
}

/// Remedy for metadata that are cut off or contradict each other.
pub(super) const DAMAGED: &str =
    "The file is damaged or cut off: copy it again, or write the mesh again";
/// Remedy for unsupported layouts, filters and versions of messages.
pub(super) const REPACK: &str =
    "Rewrite it with `h5repack -l CONTI -f NONE IN OUT`, or save it in another format";

impl Hdf5Error {
    #[cold]
    pub(super) fn damaged(at: usize, what: &str) -> Hdf5Error {
        Hdf5Error { at, problem: format!("{what} is damaged"), remedy: DAMAGED }
    }

    #[cold]
    pub(super) fn unread(at: usize, problem: impl Into<String>) -> Hdf5Error {
        Hdf5Error { at, problem: format!("cannot read {}", problem.into()), remedy: REPACK }
    }
}

/// Widths of addresses and lengths in the file, in bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct FieldWidths {
    pub(super) address: usize,
    pub(super) length: usize,
}

/// Reader of the fields of a metadata object. Numbers are little-endian.
#[derive(Clone)]
pub(super) struct ByteReader<'a> {
    all: &'a [u8],
    at: usize,
    end: usize,
    widths: FieldWidths,
    /// Name of the metadata object in error messages, such as "the superblock of the HDF5 file".
    what: &'static str,
    /// Offset of the metadata object in the file, which errors report.
    start: usize,
}

impl<'a> ByteReader<'a> {
    /// Returns a reader at offset `at` of the file `all`. An offset beyond the end is an error only when bytes are
    /// taken.
    pub(super) fn new(
        all: &'a [u8],
        at: usize,
        widths: FieldWidths,
        what: &'static str,
    ) -> ByteReader<'a> {
        ByteReader { all, at, end: all.len(), widths, what, start: at }
    }

    /// Returns a reader that is limited to `range`, cut off at the end of the file.
    pub(super) fn within(&self, range: Range<usize>) -> ByteReader<'a> {
        ByteReader { at: range.start, end: range.end.min(self.all.len()), ..*self }
    }

    #[cold]
    pub(super) fn damaged(&self) -> Hdf5Error {
        Hdf5Error::damaged(self.start, self.what)
    }

    #[cold]
    pub(super) fn unread(&self, problem: impl Into<String>) -> Hdf5Error {
        Hdf5Error::unread(self.start, problem)
    }

    pub(super) fn at(&self) -> usize {
        self.at
    }

    pub(super) fn widths(&self) -> FieldWidths {
        self.widths
    }

    pub(super) fn left(&self) -> usize {
        self.end.saturating_sub(self.at)
    }

    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], Hdf5Error> {
        let end = self.at.checked_add(count).filter(|&end| end <= self.end);
        let taken = end.and_then(|end| self.all.get(self.at..end));
        let taken = taken.ok_or_else(|| self.damaged())?;
        self.at += count;
        Ok(taken)
    }

    pub(super) fn skip(&mut self, count: usize) -> Result<(), Hdf5Error> {
        self.take(count).map(drop)
    }

    /// Takes an unsigned integer of `width` bytes, at most 8.
    pub(super) fn number(&mut self, width: usize) -> Result<u64, Hdf5Error> {
        Ok(ByteOrder::Little.whole(self.take(width)?))
    }

    /// Takes an unsigned integer of `width` bytes as a `usize`. Larger values become `usize::MAX`.
    pub(super) fn count(&mut self, width: usize) -> Result<usize, Hdf5Error> {
        Ok(usize::try_from(self.number(width)?).unwrap_or(usize::MAX))
    }

    pub(super) fn byte(&mut self) -> Result<u8, Hdf5Error> {
        Ok(self.take(1)?[0])
    }

    /// Takes an address; `None` for the undefined address, whose bits are all set.
    pub(super) fn address(&mut self) -> Result<Option<usize>, Hdf5Error> {
        let bytes = self.take(self.widths.address)?;
        let is_none = bytes.iter().all(|&byte| byte == 0xFF);
        Ok((!is_none)
            .then(|| usize::try_from(ByteOrder::Little.whole(bytes)).unwrap_or(usize::MAX)))
    }

    pub(super) fn length(&mut self) -> Result<usize, Hdf5Error> {
        self.count(self.widths.length)
    }

    /// Takes the bytes `mark`, the signature and version of a metadata object. Other bytes are an error.
    pub(super) fn expect(&mut self, mark: &[u8]) -> Result<(), Hdf5Error> {
        match self.take(mark.len())? == mark {
            true => Ok(()),
            false => Err(self.damaged()),
        }
    }

    /// Skips padding up to the next multiple of `to` bytes, counted from offset `from`.
    pub(super) fn align(&mut self, from: usize, to: usize) -> Result<(), Hdf5Error> {
        self.skip((to - (self.at - from) % to) % to)
    }
}
