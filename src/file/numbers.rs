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

/// How a single number stands in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// As a token of text. What reads the file may know only single precision.
    Text(Precision),
    /// In binary.
    Binary(Order, Precision),
}

impl Form {
    pub(crate) fn precision(self) -> Precision {
        match self {
            Form::Text(precision) | Form::Binary(_, precision) => precision,
        }
    }
}

impl From<Numbers> for Form {
    fn from(numbers: Numbers) -> Form {
        match numbers {
            Numbers::Text { precision } => Form::Text(precision),
            Numbers::Binary { order, precision, .. } => Form::Binary(order, precision),
        }
    }
}

/// Where the numbers of an array start, ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Places {
    /// Each by itself.
    List(Vec<usize>),
    /// One every so many bytes.
    Regular { start: usize, stride: usize },
}

/// Bytes that replace a range of a file.
pub(crate) struct Splice {
    pub(crate) range: Range<usize>,
    pub(crate) bytes: Vec<u8>,
}

/// Where a file says how far from their beginning an array stands in the data at its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Offset {
    pub(crate) value: usize,
    /// Where the array starts in the file.
    pub(crate) array_at: usize,
    /// Where the file has the value.
    pub(crate) place: Range<usize>,
}

/// Arrays of numbers that a file has in another form than as numbers in place: in base64, or compressed.
pub(crate) trait Encoded: Send + Sync {
    /// The numbers in binary, as they were read.
    fn bytes(&self) -> &[u8];
    /// Where they stand in the file.
    fn ranges(&self) -> Vec<Range<usize>>;
    /// What of that is replaced if these become the numbers.
    fn splices(&self, new: &[u8]) -> Vec<Splice>;
    /// What the file says of places in the data at its end: the same for all of its arrays.
    fn offsets(&self) -> &[Offset];
}
