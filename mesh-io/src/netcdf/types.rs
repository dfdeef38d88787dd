//! What numbers in a header of the classic format stand for: types of numbers, and kinds of lists.

use crate::precision::Precision;

/// The type of the numbers of a variable or attribute.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum NumberType {
    Text,
    Whole(usize),
    Real(Precision),
    /// None of these.
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
    /// Returns what the number of a type stands for. Unsigned numbers are taken for signed ones.
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

/// The numbers of types, which the format calls `NC_BYTE` and so on.
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

/// The tags of lists.
pub(super) const DIMENSIONS: u32 = 10;
pub(super) const VARIABLES: u32 = 11;
pub(super) const ATTRIBUTES: u32 = 12;
