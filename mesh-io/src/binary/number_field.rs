//! One number of each record in a list of binary records.

use crate::binary::byte_order::ByteOrder;
use crate::parallel::map_ranges;
use crate::precision::Precision;
use std::ops::Range;

/// Records that one thread reads at a time.
const CHUNK: usize = 1 << 13;

/// A number at the same offset in each record of a binary list, or several adjacent numbers.
#[derive(Clone, Copy)]
pub(crate) struct NumberField<'a> {
    /// The bytes from the first record's number on.
    pub(crate) bytes: &'a [u8],
    /// The distance from the number of one record to that of the next, in bytes.
    pub(crate) stride: usize,
    /// The width of a number in bytes.
    pub(crate) width: usize,
    pub(crate) order: ByteOrder,
}

impl<'a> NumberField<'a> {
    /// Makes a field of numbers that are `width` bytes wide and `stride` bytes apart. `bytes` start at the first
    /// record's number; `None` makes a field without records.
    pub(crate) fn new(
        bytes: Option<&'a [u8]>,
        stride: usize,
        width: usize,
        order: ByteOrder,
    ) -> NumberField<'a> {
        NumberField { bytes: bytes.unwrap_or_default(), stride, width, order }
    }

    pub(crate) fn stride(self) -> usize {
        self.stride
    }

    /// Whether this many records have this many numbers side by side.
    pub(crate) fn has_records(self, records: usize, numbers: usize) -> bool {
        let last = records.saturating_sub(1).checked_mul(self.stride);
        let end = last.and_then(|last| last.checked_add(numbers * self.width));
        self.stride > 0 && self.width > 0 && end.is_some_and(|end| end <= self.bytes.len())
    }

    /// Returns the bytes from the number on, for each of some records. The field must hold them.
    pub(crate) fn of(self, records: Range<usize>) -> impl Iterator<Item = &'a [u8]> {
        self.bytes[records.start * self.stride..].chunks(self.stride).take(records.len())
    }

    /// Returns the whole numbers of some records. The field must hold them.
    pub(crate) fn whole(self, records: Range<usize>) -> impl Iterator<Item = u64> {
        self.of(records).map(move |bytes| self.order.whole(&bytes[..self.width]))
    }

    /// Returns the real numbers of some records. The field must hold them.
    pub(crate) fn real(self, records: Range<usize>) -> impl Iterator<Item = f64> {
        let precision = if self.width == 4 { Precision::Single } else { Precision::Double };
        self.of(records).map(move |bytes| self.order.real(precision, &bytes[..self.width]))
    }

    /// Returns the bytes of the number of one record. The field must hold it.
    pub(crate) fn at(self, record: usize) -> &'a [u8] {
        &self.bytes[record * self.stride..][..self.width]
    }

    /// Returns the real number of one record. The field must hold it.
    pub(crate) fn real_at(self, record: usize) -> f64 {
        let precision = if self.width == 4 { Precision::Single } else { Precision::Double };
        self.order.real(precision, self.at(record))
    }

    /// Whether `holds` is true for the real numbers of this many records. False if there are fewer.
    pub(crate) fn all_real(self, records: usize, holds: impl Fn(f64) -> bool + Sync) -> bool {
        let fits = matches!(self.width, 4 | 8) && self.has_records(records, 1);
        let each = |records| self.real(records).all(&holds);
        fits && map_ranges(records, CHUNK, each).into_iter().all(|all| all)
    }

    /// Returns the largest number of this width that is positive if it is read as signed. Larger ones are left to the
    /// reader.
    pub(crate) fn max(self) -> u64 {
        u64::MAX >> (65 - 8 * self.width.clamp(1, 8))
    }
}
