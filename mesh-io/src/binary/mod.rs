//! Binary numbers: byte orders, numbers in records of one size, and lists of whole numbers.

pub(crate) mod number_field;
pub(crate) mod order;
pub(crate) mod whole;
