//! Arrays of unsigned integers in the binary form of a file.

use crate::binary::byte_order::ByteOrder;
use crate::binary::number_field::NumberField;
use crate::parallel::map_ranges;

use std::borrow::Cow;
use std::ops::Range;

/// Number of adjacent pairs that one task of [`IntArray::is_sorted`] compares.
const CHUNK: usize = 1 << 14;

/// Array of unsigned integers of one width, borrowed from a binary file or collected. Collected integers take 4 bytes
/// each, or 8 bytes once an integer exceeds `u32::MAX`.
pub(crate) struct IntArray<'a> {
    bytes: Cow<'a, [u8]>,
    /// Width of an integer in bytes.
    size: usize,
    order: ByteOrder,
}

impl<'a> IntArray<'a> {
    /// Makes an array of integers of `size` bytes each. Left-over bytes at the end are ignored.
    pub(crate) fn binary(bytes: Cow<'a, [u8]>, size: usize, order: ByteOrder) -> IntArray<'a> {
        IntArray { bytes, size, order }
    }

    /// Makes an empty array with room for `count` integers of 4 bytes.
    pub(crate) fn with_capacity(count: usize) -> IntArray<'a> {
        IntArray {
            bytes: Cow::Owned(Vec::with_capacity(4 * count)),
            size: 4,
            order: ByteOrder::Little,
        }
    }

    /// Appends an integer to an array that was made by [`with_capacity`](Self::with_capacity).
    #[inline]
    pub(crate) fn push(&mut self, number: u64) {
        if self.size == 4 && number > u64::from(u32::MAX) {
            self.widen();
        }
        let bytes = number.to_le_bytes();
        self.bytes.to_mut().extend_from_slice(&bytes[..self.size]);
    }

    #[cold]
    fn widen(&mut self) {
        let numbers = self.range(0..self.len());
        self.bytes = Cow::Owned(numbers.flat_map(u64::to_le_bytes).collect());
        self.size = 8;
    }

    pub(crate) fn len(&self) -> usize {
        self.bytes.len() / self.size
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the integer at `index`. An index beyond the end panics.
    #[inline]
    pub(crate) fn at(&self, index: usize) -> u64 {
        self.order.whole(&self.bytes[index * self.size..][..self.size])
    }

    /// Returns the integers at a range of indices. A range beyond the end panics.
    pub(crate) fn range(&self, places: Range<usize>) -> impl Iterator<Item = u64> {
        let bytes = &self.bytes[places.start * self.size..places.end * self.size];
        bytes.chunks_exact(self.size).map(|number| self.order.whole(number))
    }

    pub(crate) fn is_sorted(&self) -> bool {
        let pairs = self.len().saturating_sub(1);
        let each = |pairs: Range<usize>| self.range(pairs.start..pairs.end + 1).is_sorted();
        map_ranges(pairs, CHUNK, each).into_iter().all(|is| is)
    }

    /// Returns every `step`-th integer from index `from` on, as a field of records.
    pub(crate) fn field(&self, from: usize, step: usize) -> NumberField<'_> {
        let bytes = from.checked_mul(self.size).and_then(|at| self.bytes.get(at..));
        NumberField::new(bytes, step * self.size, self.size, self.order)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_text_are_kept_whatever_their_size() {
        let numbers = [3, 0, u64::from(u32::MAX), 7, 1 << 40, u64::MAX, 1];
        let mut whole = IntArray::with_capacity(2);
        for (count, &number) in numbers.iter().enumerate() {
            whole.push(number);
            let all: Vec<u64> = whole.range(0..whole.len()).collect();
            assert_eq!(all, numbers[..=count]);
            assert_eq!(whole.at(count), number);
        }
    }

    #[test]
    fn a_list_is_sorted_if_no_number_is_less_than_the_one_before() {
        for count in [0, 1, 2, CHUNK, CHUNK + 1, 3 * CHUNK] {
            let bytes: Vec<u8> = (1..=count as u32).flat_map(u32::to_be_bytes).collect();
            let is_sorted =
                |bytes: &[u8]| IntArray::binary(bytes.into(), 4, ByteOrder::Big).is_sorted();
            assert!(is_sorted(&bytes), "{count}");
            for wrong in [1, CHUNK - 1, CHUNK, count / 2, count.saturating_sub(1)] {
                if (1..count).contains(&wrong) {
                    let mut bytes = bytes.clone();
                    bytes[4 * wrong..][..4].fill(0);
                    assert!(!is_sorted(&bytes), "{wrong} of {count}");
                }
            }
        }
    }
}
