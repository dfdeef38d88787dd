//! The types of the numbers of variables and attributes.

use crate::precision::Precision;

/// The types of numbers that are told apart.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Number {
    Text,
    Whole(usize),
    Real(Precision),
    /// None of these.
    Other(usize),
}

impl Number {
    pub(crate) fn bytes(self) -> usize {
        match self {
            Number::Text => 1,
            Number::Whole(bytes) | Number::Other(bytes) => bytes,
            Number::Real(precision) => precision.bytes(),
        }
    }
}
