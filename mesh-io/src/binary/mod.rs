//! Binary numbers: byte orders, numbers in records of one size, and lists of whole numbers.

pub(crate) mod byte_order;
pub(crate) mod int_array;
pub(crate) mod number_field;
