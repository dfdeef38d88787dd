//! The version of a file and how its numbers are stored.

use crate::binary::order::Order;
use crate::edit::numbers::Form;
use crate::precision::Precision;

/// The version of the format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    V2,
    V40,
    V4,
}

/// The version and byte order that `$MeshFormat` gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Encoding {
    pub(super) version: Version,
    /// The byte order of binary numbers; `None` for text.
    pub(super) order: Option<Order>,
}

/// Returns how a number is stored in the file.
pub(super) fn form(order: Option<Order>) -> Form {
    match order {
        None => Form::Text(Precision::Double),
        Some(order) => Form::Binary(order, Precision::Double),
    }
}
