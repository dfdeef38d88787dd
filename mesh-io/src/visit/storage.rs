//! How and where a file stores coordinates and other numbers, known after it was read.

use crate::edit::numbers::{CoordinateEncoding, EncodedArrays, NumberEncoding, Offsets};
use crate::format::Format;
use std::sync::Arc;

/// Offsets and encoding of the numbers of an array, by which the numbers can be replaced.
pub(crate) struct ArrayLocation {
    pub(crate) offsets: Offsets,
    pub(crate) encoding: NumberEncoding,
    pub(crate) space: ByteSpace,
    /// The index of the file with the array, in the order of [`Source::files`](crate::disk::source::Source::files).
    pub(crate) file_index: usize,
}

impl ArrayLocation {
    /// Makes the value for numbers that stand in the file itself.
    pub(crate) fn in_place(offsets: Offsets, encoding: NumberEncoding) -> Option<ArrayLocation> {
        Some(ArrayLocation { offsets, encoding, space: ByteSpace::File, file_index: 0 })
    }
}

/// The bytes to which the offsets of an array refer.
pub(crate) enum ByteSpace {
    File,
    /// The decoded bytes of the encoded points.
    Points,
    /// Those of an array that is encoded itself, perhaps with other arrays.
    Encoded(Arc<dyn EncodedArrays>),
}

/// Encoding and location of the coordinates of a file, known after the file was read.
pub(crate) struct CoordinateStorage {
    pub(crate) format: Format,
    pub(crate) encoding: CoordinateEncoding,
    /// The encoded points, if they are encoded. The offsets of coordinates are then those in its decoded bytes.
    pub(crate) encoded: Option<Box<dyn EncodedArrays>>,
    /// All occurrences of coordinates, if the file may repeat a vertex; else `None`.
    pub(crate) repeated_vertices: Option<RepeatedVertices>,
    /// The index of the file with the coordinates, in the order of
    /// [`Source::files`](crate::disk::source::Source::files).
    pub(crate) file_index: usize,
}

/// All occurrences of coordinates in a file that repeats vertices, such as an STL.
pub(crate) struct RepeatedVertices {
    /// The offset of each x, ascending.
    pub(crate) x_at: Vec<usize>,
    /// The index of each x's vertex.
    pub(crate) vertices: Vec<u32>,
}

impl CoordinateStorage {
    /// Makes the layout of a file that has its coordinates in place.
    pub(crate) fn in_place(format: Format, numbers: CoordinateEncoding) -> CoordinateStorage {
        CoordinateStorage {
            format,
            encoding: numbers,
            encoded: None,
            repeated_vertices: None,
            file_index: 0,
        }
    }
}
