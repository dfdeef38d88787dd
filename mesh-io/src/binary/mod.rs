//! Binary numbers: byte orders, fields of records, and arrays of unsigned integers.

pub(crate) mod byte_order;
pub(crate) mod int_array;
pub(crate) mod number_field;
