//! Types of numbers, with their codes in headers of the classic format, and the tags of lists there.

use crate::precision::Precision;

/// The type of the numbers of a variable or attribute.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum NumberType {
    Text,
    /// Integers of this many bytes.
    Whole(usize),
    Real(Precision),
    /// Any other type, with the size of an item in bytes.
    Other(usize),
}

impl NumberType {
    pub(crate) fn bytes(self) -> usize {
        match self {
            NumberType::Text => 1,
            NumberType::Whole(bytes) | NumberType::Other(bytes) => bytes,
            NumberType::Real(precision) => precision.bytes(),
        }
    }
    /// Returns the type with a code of the format; `None` for unknown codes. Unsigned integers are read as signed
    /// integers.
    pub(super) fn of_type(number: u32) -> Option<NumberType> {
        match number {
            CHAR => Some(NumberType::Text),
            BYTE | UBYTE => Some(NumberType::Whole(1)),
            SHORT | USHORT => Some(NumberType::Whole(2)),
            INT | UINT => Some(NumberType::Whole(4)),
            INT64 | UINT64 => Some(NumberType::Whole(8)),
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
