//! Numbers at the same offset in each record of a binary list.

use crate::binary::byte_order::ByteOrder;
use crate::parallel::map_ranges;
use crate::precision::Precision;
use std::ops::Range;

/// Number of records that one task of [`NumberField::all_real`] reads.
const CHUNK: usize = 1 << 13;

/// A number at the same offset in each record of a binary list, or several adjacent numbers.
#[derive(Clone, Copy)]
pub(crate) struct NumberField<'a> {
    /// Bytes of the list, which begin with the first record's number.
    pub(crate) bytes: &'a [u8],
    /// Distance between the numbers of successive records, in bytes.
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

    /// Returns whether the field has `records` records with `numbers` adjacent numbers each.
    pub(crate) fn has_records(self, records: usize, numbers: usize) -> bool {
        let last = records.saturating_sub(1).checked_mul(self.stride);
        let end = last.and_then(|last| last.checked_add(numbers * self.width));
        self.stride > 0 && self.width > 0 && end.is_some_and(|end| end <= self.bytes.len())
    }

    /// Returns, for each record of a range, `stride` bytes from its number on, fewer at the end of the list. The field
    /// must hold the records.
    pub(crate) fn of(self, records: Range<usize>) -> impl Iterator<Item = &'a [u8]> {
        self.bytes[records.start * self.stride..].chunks(self.stride).take(records.len())
    }

    /// Returns the unsigned integers of a range of records, which the field must hold.
    pub(crate) fn whole(self, records: Range<usize>) -> impl Iterator<Item = u64> {
        self.of(records).map(move |bytes| self.order.whole(&bytes[..self.width]))
    }

    /// Returns the real numbers of a range of records, which the field must hold.
    pub(crate) fn real(self, records: Range<usize>) -> impl Iterator<Item = f64> {
        let precision = if self.width == 4 { Precision::Single } else { Precision::Double };
        self.of(records).map(move |bytes| self.order.real(precision, &bytes[..self.width]))
    }

    /// Returns the bytes of one record's number. The field must hold the record.
    pub(crate) fn at(self, record: usize) -> &'a [u8] {
        &self.bytes[record * self.stride..][..self.width]
    }

    /// Returns the real number of one record, which the field must hold.
    pub(crate) fn real_at(self, record: usize) -> f64 {
        let precision = if self.width == 4 { Precision::Single } else { Precision::Double };
        self.order.real(precision, self.at(record))
    }

    /// Returns whether `holds` is true for the real numbers of the first `records` records; false if the field has
    /// fewer.
    pub(crate) fn all_real(self, records: usize, holds: impl Fn(f64) -> bool + Sync) -> bool {
        let fits = matches!(self.width, 4 | 8) && self.has_records(records, 1);
        let each = |records| self.real(records).all(&holds);
        fits && map_ranges(records, CHUNK, each).into_iter().all(|all| all)
    }

    /// Returns the largest signed integer of this width. A record with a larger unsigned value may hold a negative
    /// number and is parsed one by one.
    pub(crate) fn max(self) -> u64 {
        u64::MAX >> (65 - 8 * self.width.clamp(1, 8))
    }
}
