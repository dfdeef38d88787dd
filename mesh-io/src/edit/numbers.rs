//! Encodings and offsets of coordinates and other numbers in a file.

use crate::binary::byte_order::ByteOrder;
use crate::precision::{Precision, short_text};
use crate::text::card;
use crate::text::field_text::{MAX_LENGTH, field_text};
use crate::text::token::{number_end, skip_to_number};
use std::io::Write;
use std::ops::Range;

/// Encoding of the two coordinates of a vertex, relative to the offset of x.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CoordinateEncoding {
    /// Text, with y as the next token behind x. Programs that read the text may store less than double precision.
    Text { precision: Precision },
    /// Text in fields of a Nastran card, with y in the next field behind x.
    Fields { precision: Precision },
    /// Binary numbers. y starts `y_after` bytes behind x, or before x for a negative distance.
    Binary { order: ByteOrder, precision: Precision, y_after: isize },
}

impl CoordinateEncoding {
    /// Text of double precision.
    pub(crate) const TEXT: CoordinateEncoding =
        CoordinateEncoding::Text { precision: Precision::Double };

    /// Returns the encoding of binary numbers with y directly behind x.
    pub(crate) fn adjacent(order: ByteOrder, precision: Precision) -> CoordinateEncoding {
        CoordinateEncoding::Binary { order, precision, y_after: precision.bytes() as isize }
    }

    pub(crate) fn precision(self) -> Precision {
        match self {
            CoordinateEncoding::Text { precision }
            | CoordinateEncoding::Fields { precision }
            | CoordinateEncoding::Binary { precision, .. } => precision,
        }
    }
}

/// Encoding of individual numbers in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NumberEncoding {
    /// Token of text. Programs that read the text may store less than double precision.
    Text(Precision),
    /// Text in a field of a Nastran card.
    Field(Precision),
    /// Binary number.
    Binary(ByteOrder, Precision),
}

impl NumberEncoding {
    pub(crate) fn precision(self) -> Precision {
        match self {
            NumberEncoding::Text(precision)
            | NumberEncoding::Field(precision)
            | NumberEncoding::Binary(_, precision) => precision,
        }
    }

    /// Returns the exclusive end of the number at `at`, and the width to which a replacement is padded with blanks: the
    /// width of a fixed field, or 0 if any length fits.
    pub(crate) fn extent(self, bytes: &[u8], at: usize) -> (usize, usize) {
        match self {
            NumberEncoding::Text(_) => (number_end(bytes, at), 0),
            NumberEncoding::Field(_) => card::extent(bytes, at),
            NumberEncoding::Binary(_, precision) => (at + precision.bytes(), 0),
        }
    }

    /// Returns the start of y, given the exclusive end of x. Meaningful for text encodings only.
    pub(crate) fn next(self, bytes: &[u8], end: usize) -> usize {
        match self {
            NumberEncoding::Field(_) => card::next_field(bytes, end),
            _ => skip_to_number(bytes, end),
        }
    }

    /// Appends an encoded number. The caller has rounded `value` to the precision. Text has the fewest digits that
    /// parse back to the same bits.
    pub(crate) fn write(self, value: f64, out: &mut Vec<u8>) {
        match self {
            NumberEncoding::Field(precision) => {
                let most = match precision {
                    Precision::Text8 => 8,
                    Precision::Text16 => 16,
                    _ => MAX_LENGTH,
                };
                out.extend_from_slice(field_text(value, most).as_bytes());
            }
            NumberEncoding::Text(Precision::Single) => {
                write!(out, "{:?}", value as f32).expect("memory takes what is written to it");
            }
            NumberEncoding::Text(Precision::Text20) => {
                out.extend_from_slice(short_text(value).as_bytes())
            }
            NumberEncoding::Text(_) => write_shortest(value, out),
            NumberEncoding::Binary(order, Precision::Single) => {
                out.extend_from_slice(&order.single_bytes(value as f32));
            }
            NumberEncoding::Binary(order, _) => out.extend_from_slice(&order.bytes(value)),
        }
    }
}

/// Appends a number as `{:?}` does, with the fewest digits that parse back to the same bits.
fn write_shortest(value: f64, out: &mut Vec<u8>) {
    // Both write these numbers without an exponent. If two texts of the fewest digits are equally near, the standard library
    // takes the greater and the crate the even text. Below 1e11, the last ten bits of such a number are zero.
    let is_alike = value.to_bits() & 0xff != 0;
    if is_alike && (1e-4..1e11).contains(&value.abs()) {
        out.extend_from_slice(zmij::Buffer::new().format_finite(value).as_bytes());
    } else {
        write!(out, "{value:?}").expect("memory takes what is written to it");
    }
}

impl From<CoordinateEncoding> for NumberEncoding {
    fn from(numbers: CoordinateEncoding) -> NumberEncoding {
        match numbers {
            CoordinateEncoding::Text { precision } => NumberEncoding::Text(precision),
            CoordinateEncoding::Fields { precision } => NumberEncoding::Field(precision),
            CoordinateEncoding::Binary { order, precision, .. } => {
                NumberEncoding::Binary(order, precision)
            }
        }
    }
}

/// Byte offsets of the numbers of an array, ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Offsets {
    /// An offset for each number.
    List(Vec<usize>),
    /// One number every `stride` bytes.
    Regular { start: usize, stride: usize },
}

impl Offsets {
    /// Returns the offset of the number at a 0-based index.
    #[inline]
    pub(crate) fn at(&self, index: usize) -> usize {
        match self {
            Offsets::List(list) => list[index],
            Offsets::Regular { start, stride } => start + index * stride,
        }
    }
}

/// Builder of [`Offsets`]. Stores start, stride and count while offsets are evenly spaced, and a list of all offsets
/// after the first irregular distance.
#[derive(Default)]
pub(crate) struct OffsetsBuilder {
    start: usize,
    stride: usize,
    count: usize,
    /// All offsets; empty while offsets are evenly spaced.
    list: Vec<usize>,
    /// Announced number of offsets, for which the list reserves memory.
    expected: usize,
}

impl OffsetsBuilder {
    pub(crate) fn expect(&mut self, more: usize) {
        self.expected = self.count + more;
    }

    #[inline]
    pub(crate) fn push(&mut self, at: usize) {
        if !self.list.is_empty() {
            self.list.push(at);
        } else if self.count > 1 && at == self.start + self.count * self.stride {
            self.count += 1;
        } else {
            self.extend(at, 0, 1);
        }
    }

    /// Appends `count` offsets that are `stride` bytes apart.
    pub(crate) fn extend(&mut self, start: usize, stride: usize, count: usize) {
        let follows = match (self.count, count) {
            (_, 0) => return,
            (0, _) => {
                (self.start, self.stride) = (start, stride);
                true
            }
            (1, 1) if start > self.start => {
                self.stride = start - self.start;
                true
            }
            (own, more) => {
                self.list.is_empty()
                    && start == self.start + own * self.stride
                    && (more == 1 || stride == self.stride)
            }
        };
        if !follows {
            if self.list.is_empty() {
                self.list.reserve_exact(self.expected.max(self.count + count));
                self.list.extend((0..self.count).map(|index| self.start + index * self.stride));
            }
            self.list.extend((0..count).map(|index| start + index * stride));
        }
        self.count += count;
    }

    /// Returns the offset at a 0-based index.
    pub(crate) fn at(&self, index: usize) -> usize {
        match self.list.is_empty() {
            true => self.start + index * self.stride,
            false => self.list[index],
        }
    }

    pub(crate) fn finish(self) -> Offsets {
        match self.list.is_empty() {
            true => Offsets::Regular { start: self.start, stride: self.stride },
            false => Offsets::List(self.list),
        }
    }
}

/// A range of a file and the bytes that replace the range.
#[derive(Clone)]
pub(crate) struct ByteEdit {
    pub(crate) range: Range<usize>,
    pub(crate) bytes: Vec<u8>,
}

/// A number in a VTK XML file that gives the distance of an array from the start of the appended data, in bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct AppendedOffset {
    pub(crate) value: usize,
    /// Offset of the array from the start of the file, in bytes.
    pub(crate) array_start: usize,
    /// Byte range of the number's text in the file.
    pub(crate) range: Range<usize>,
}

/// Arrays of numbers that a file stores in base64, or compressed, or both.
pub(crate) trait EncodedArrays: Send + Sync {
    /// Returns the decoded numbers in binary, as they were read.
    fn bytes(&self) -> &[u8];
    /// Returns the ranges of the file that hold the encoded arrays.
    fn ranges(&self) -> Vec<Range<usize>>;
    /// Returns the edits that store the decoded bytes `new`. `end` is the length of the file with all bytes appended
    /// so far; appended bytes are an edit at the end of the original file, and increase `end`.
    fn edits(&self, file: &[u8], new: &[u8], end: &mut usize) -> Vec<ByteEdit>;
    /// Returns the edits that follow from `edits`: offsets of appended arrays (VTK XML), or the end address and
    /// checksums (HDF5). `end` is the length of the file with all edits applied. Arrays that share such a range
    /// return equal bytes for the range.
    fn dependent_edits(&self, file: &[u8], edits: &[ByteEdit], end: usize) -> Vec<ByteEdit>;
    /// Returns the ranges that [`dependent_edits`](Self::dependent_edits) may edit if no array before byte `first`
    /// changes its length.
    fn dependent_ranges(&self, first: usize) -> Vec<Range<usize>>;
    /// Returns whether bytes outside of the arrays keep their offsets, whatever the lengths of the arrays.
    fn preserves_offsets(&self) -> bool;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_the_standard_library_writes_them() {
        let check = |value: f64| {
            let mut text = Vec::new();
            write_shortest(value, &mut text);
            assert_eq!(String::from_utf8(text).unwrap(), format!("{value:?}"));
        };
        let ends = [1e-4, 1e-5, 9.999_999_999_999_999e-5, 1e15, 1e16, 9_999_999_999_999_998.0];
        let special = [0.0, 1.0, 0.1, 0.3, 1e23, 5e-324, f64::MAX, f64::NAN, f64::INFINITY];
        ends.into_iter().chain(special).for_each(|value| {
            check(value);
            check(-value);
        });
        let mut state = 1_u64;
        for round in 0..100_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            // All numbers, numbers of usual magnitude, of single precision, and of few digits.
            match round % 4 {
                0 => check(f64::from_bits(state)),
                1 => check((state >> 11) as f64 * 10f64.powi((state % 41) as i32 - 30)),
                2 => check(f64::from((state >> 40) as f32 / 2f32.powi((state % 60) as i32 - 30))),
                _ => check((state >> 44) as f64 / 10f64.powi((state % 9) as i32)),
            }
        }
    }

    #[test]
    fn places_of_numbers_are_kept_as_they_were_added() {
        type Run = (usize, usize, usize);
        let cases: [(&[Run], bool); 8] = [
            (&[], true),
            (&[(7, 0, 1)], true),
            (&[(7, 0, 1), (10, 0, 1), (13, 0, 1), (16, 3, 4)], true),
            (&[(7, 3, 4), (19, 0, 1), (22, 3, 2)], true),
            (&[(7, 3, 4), (20, 0, 1), (21, 0, 1)], false),
            (&[(7, 3, 4), (19, 4, 3)], false),
            (&[(7, 0, 1), (10, 4, 3)], false),
            (&[(7, 0, 1), (10, 0, 1), (14, 0, 1), (18, 5, 3), (40, 0, 0)], false),
        ];
        for (runs, is_regular) in cases {
            let mut found = OffsetsBuilder::default();
            let mut expected = Vec::new();
            for &(start, stride, count) in runs {
                match count {
                    1 => found.push(start),
                    _ => found.extend(start, stride, count),
                }
                expected.extend((0..count).map(|index| start + index * stride));
            }
            let all: Vec<usize> = (0..expected.len()).map(|index| found.at(index)).collect();
            assert_eq!(all, expected, "{runs:?}");
            let places = found.finish();
            assert_eq!(matches!(places, Offsets::Regular { .. }), is_regular, "{runs:?}");
            let all: Vec<usize> = (0..expected.len()).map(|index| places.at(index)).collect();
            assert_eq!(all, expected, "{runs:?}");
        }
    }
}
