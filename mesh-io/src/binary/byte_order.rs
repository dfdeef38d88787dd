//! Numbers in binary files, in either byte order.

use crate::precision::Precision;

/// Byte order of binary numbers: little-endian or big-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ByteOrder {
    /// The lowest byte comes first.
    Little,
    /// The highest byte comes first.
    Big,
}

/// A type of integers in a binary file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct IntegerType {
    /// Width of an integer in bytes, from 1 to 8.
    pub(crate) bytes: usize,
    pub(crate) is_signed: bool,
}

impl ByteOrder {
    #[inline]
    pub(crate) fn i32(self, bytes: [u8; 4]) -> i32 {
        match self {
            ByteOrder::Little => i32::from_le_bytes(bytes),
            ByteOrder::Big => i32::from_be_bytes(bytes),
        }
    }

    #[inline]
    pub(crate) fn u64(self, bytes: [u8; 8]) -> u64 {
        match self {
            ByteOrder::Little => u64::from_le_bytes(bytes),
            ByteOrder::Big => u64::from_be_bytes(bytes),
        }
    }

    #[inline]
    pub(crate) fn f64(self, bytes: [u8; 8]) -> f64 {
        f64::from_bits(self.u64(bytes))
    }

    #[inline]
    pub(crate) fn f32(self, bytes: [u8; 4]) -> f32 {
        match self {
            ByteOrder::Little => f32::from_le_bytes(bytes),
            ByteOrder::Big => f32::from_be_bytes(bytes),
        }
    }

    /// Reads a real number: 4 bytes in single precision, 8 bytes in any other.
    #[inline]
    pub(crate) fn real(self, precision: Precision, bytes: &[u8]) -> f64 {
        match precision {
            Precision::Single => f64::from(self.f32(bytes.try_into().expect("four bytes"))),
            _ => self.f64(bytes.try_into().expect("eight bytes")),
        }
    }

    /// Reads an unsigned integer of up to 8 bytes.
    #[inline]
    pub(crate) fn whole(self, bytes: &[u8]) -> u64 {
        // Separate branches for widths of 4 and 8 bytes are several times as fast as the fold.
        if let Ok(bytes) = <[u8; 4]>::try_from(bytes) {
            return u64::from(self.i32(bytes).cast_unsigned());
        }
        if let Ok(bytes) = <[u8; 8]>::try_from(bytes) {
            return self.u64(bytes);
        }
        let append = |number: u64, &byte: &u8| number << 8 | u64::from(byte);
        match self {
            ByteOrder::Big => bytes.iter().fold(0, append),
            ByteOrder::Little => bytes.iter().rev().fold(0, append),
        }
    }

    /// Reads a signed integer of up to 8 bytes.
    #[inline]
    pub(crate) fn signed(self, bytes: &[u8]) -> i64 {
        let unused = 64 - 8 * bytes.len();
        self.whole(bytes).cast_signed() << unused >> unused
    }

    /// Reads an integer of a type. Unsigned integers from 2^63 on keep their bits.
    #[inline]
    pub(crate) fn integer(self, number: IntegerType, bytes: &[u8]) -> i64 {
        if number.is_signed { self.signed(bytes) } else { self.whole(bytes).cast_signed() }
    }

    /// Reads an integer of a type as a real number.
    #[inline]
    pub(crate) fn integer_as_real(self, number: IntegerType, bytes: &[u8]) -> f64 {
        if number.is_signed { self.signed(bytes) as f64 } else { self.whole(bytes) as f64 }
    }

    #[inline]
    pub(crate) fn single_bytes(self, number: f32) -> [u8; 4] {
        match self {
            ByteOrder::Little => number.to_le_bytes(),
            ByteOrder::Big => number.to_be_bytes(),
        }
    }

    #[inline]
    pub(crate) fn bytes(self, number: f64) -> [u8; 8] {
        match self {
            ByteOrder::Little => number.to_le_bytes(),
            ByteOrder::Big => number.to_be_bytes(),
        }
    }
}
