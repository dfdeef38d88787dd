//! The version of a file and how its numbers are stored.

use crate::binary::byte_order::ByteOrder;
use crate::edit::numbers::NumberEncoding;
use crate::precision::Precision;

/// The version of the format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    V2,
    V40,
    V41,
}

/// Version of the format, and byte order if the file is binary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FileEncoding {
    pub(super) version: Version,
    /// The byte order of binary numbers; `None` for text.
    pub(super) order: Option<ByteOrder>,
}

/// Returns how a number is stored in the file.
pub(super) fn form(order: Option<ByteOrder>) -> NumberEncoding {
    match order {
        None => NumberEncoding::Text(Precision::Double),
        Some(order) => NumberEncoding::Binary(order, Precision::Double),
    }
}
