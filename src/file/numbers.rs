//! How the coordinates stand in a file.

use crate::file::binary::Order;
use crate::mesh::Precision;
use std::ops::Range;

/// How the coordinates of a vertex stand in its file, from where its x starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Numbers {
    /// As text, y the token after x. What reads the file may know only single precision.
    Text { precision: Precision },
    /// In binary, y so many bytes after x.
    Binary { order: Order, precision: Precision, y_after: usize },
}

impl Numbers {
    /// Text with all digits.
    pub(crate) const TEXT: Numbers = Numbers::Text { precision: Precision::Double };

    /// Numbers in binary, y next to x.
    pub(crate) fn adjacent(order: Order, precision: Precision) -> Numbers {
        Numbers::Binary { order, precision, y_after: precision.bytes() }
    }

    pub(crate) fn precision(self) -> Precision {
        match self {
            Numbers::Text { precision } | Numbers::Binary { precision, .. } => precision,
        }
    }
}

/// Bytes that replace a range of a file.
pub(crate) struct Splice {
    pub(crate) range: Range<usize>,
    pub(crate) bytes: Vec<u8>,
}

/// Points that a file has in another form than as numbers in place: in base64, or compressed.
pub(crate) trait Encoded: Send + Sync {
    /// The numbers in binary, as they were read.
    fn bytes(&self) -> &[u8];
    /// The ranges of the file that may change where vertices move, ascending.
    fn ranges(&self) -> Vec<Range<usize>>;
    /// What changes in the file if these become the numbers: ranges of the file, ascending.
    fn splices(&self, new: &[u8]) -> Vec<Splice>;
}
