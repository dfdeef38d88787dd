//! Types of numbers, with their codes in headers of the classic format, and the tags of lists there.

use crate::binary::byte_order::IntegerType;
use crate::precision::Precision;

/// The type of the numbers of a variable or attribute.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum NumberType {
    Text,
    Whole(IntegerType),
    Real(Precision),
    /// Any other type, with the size of an item in bytes.
    Other(usize),
}

impl NumberType {
    pub(crate) fn bytes(self) -> usize {
        match self {
            NumberType::Text => 1,
            NumberType::Whole(number) => number.bytes,
            NumberType::Other(bytes) => bytes,
            NumberType::Real(precision) => precision.bytes(),
        }
    }

    /// Returns the type with a code of the format; `None` for unknown codes.
    pub(super) fn of_type(number: u32) -> Option<NumberType> {
        let integer = |bytes, is_signed| Some(NumberType::Whole(IntegerType { bytes, is_signed }));
        match number {
            CHAR => Some(NumberType::Text),
            BYTE | UBYTE => integer(1, number == BYTE),
            SHORT | USHORT => integer(2, number == SHORT),
            INT | UINT => integer(4, number == INT),
            INT64 | UINT64 => integer(8, number == INT64),
            FLOAT => Some(NumberType::Real(Precision::Single)),
            DOUBLE => Some(NumberType::Real(Precision::Double)),
            _ => None,
        }
    }
}

/// Codes of types: `NC_BYTE` and so on in the format specification.
const BYTE: u32 = 1;
pub(super) const CHAR: u32 = 2;
const SHORT: u32 = 3;
pub(super) const INT: u32 = 4;
pub(super) const FLOAT: u32 = 5;
pub(super) const DOUBLE: u32 = 6;
const UBYTE: u32 = 7;
const USHORT: u32 = 8;
const UINT: u32 = 9;
const INT64: u32 = 10;
const UINT64: u32 = 11;

/// Tags of the lists of dimensions, variables and attributes in the header.
pub(super) const DIMENSIONS: u32 = 10;
pub(super) const VARIABLES: u32 = 11;
pub(super) const ATTRIBUTES: u32 = 12;
