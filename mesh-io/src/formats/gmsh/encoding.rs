//! Version and number encoding of a gmsh file.

use crate::binary::byte_order::ByteOrder;
use crate::edit::numbers::NumberEncoding;
use crate::precision::Precision;

/// Version of the format. `V1` has no section `$MeshFormat`, and `$NOD` and `$ELM` in place of `$Nodes` and
/// `$Elements`. `V2` stands for 2.0 to 2.2, `V40` for 4 and 4.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    V1,
    V2,
    V40,
    V41,
}

/// Version of the format, and the byte order of binary files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FileEncoding {
    pub(super) version: Version,
    /// Byte order of binary numbers; `None` for text.
    pub(super) order: Option<ByteOrder>,
}

/// Returns the encoding of a floating-point number in the file; text if `order` is `None`.
pub(super) fn form(order: Option<ByteOrder>) -> NumberEncoding {
    match order {
        None => NumberEncoding::Text(Precision::Double),
        Some(order) => NumberEncoding::Binary(order, Precision::Double),
    }
}
