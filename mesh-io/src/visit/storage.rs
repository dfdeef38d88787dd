//! Encodings and locations of coordinates and other numbers in a file, known after reading.

use crate::edit::numbers::{CoordinateEncoding, EncodedArrays, NumberEncoding, Offsets};
use crate::format::Format;
use crate::visit::shared::SharedBytes;
use std::sync::Arc;

/// Offsets and encoding of an array's numbers, for replacing the numbers in a rewrite.
pub(crate) struct ArrayLocation {
    pub(crate) offsets: Offsets,
    pub(crate) encoding: NumberEncoding,
    pub(crate) space: ByteSpace,
    /// The index of the file with the array, in the order of [`Source::files`](crate::disk::source::Source::files).
    pub(crate) file_index: usize,
    /// The bytes of the array that other arrays have too; `None` if the array has bytes of its own.
    pub(crate) shared: Option<SharedBytes>,
}

impl ArrayLocation {
    /// Returns the location, always `Some`, of numbers that the main file stores unencoded.
    pub(crate) fn in_place(offsets: Offsets, encoding: NumberEncoding) -> Option<ArrayLocation> {
        Some(ArrayLocation {
            offsets,
            encoding,
            space: ByteSpace::File,
            file_index: 0,
            shared: None,
        })
    }
}

/// The bytes to which the offsets of an array refer.
pub(crate) enum ByteSpace {
    File,
    /// The decoded bytes of the encoded points.
    Points,
    /// The decoded bytes of other arrays that are encoded together.
    Encoded(Arc<dyn EncodedArrays>),
}

/// Encoding and location of the coordinates of a file, known after the file was read.
pub(crate) struct CoordinateStorage {
    pub(crate) format: Format,
    pub(crate) encoding: CoordinateEncoding,
    /// Encoded array of the points, if the file stores points in base64 or compressed. Offsets of coordinates then
    /// refer to the decoded bytes.
    pub(crate) encoded: Option<Box<dyn EncodedArrays>>,
    /// All occurrences of coordinates, if the file may repeat a vertex; else `None`.
    pub(crate) repeated_vertices: Option<RepeatedVertices>,
    /// The index of the file with the coordinates, in the order of
    /// [`Source::files`](crate::disk::source::Source::files).
    pub(crate) file_index: usize,
    /// Whether attributes of the coordinates say that they are longitude and latitude in degrees; `None` if no attribute
    /// gives a unit.
    pub(crate) says_degrees: Option<bool>,
    /// Another array with bytes of the points, in messages; `None` if the points have bytes of their own.
    pub(crate) shared_with: Option<String>,
}

/// All occurrences of coordinates in a file that repeats vertices, such as an STL.
pub(crate) struct RepeatedVertices {
    /// The offset of each x, ascending.
    pub(crate) x_at: Vec<usize>,
    /// The vertex of each offset in `x_at`.
    pub(crate) vertices: Vec<u32>,
}

impl CoordinateStorage {
    /// Returns the storage of a main file with unencoded coordinates, each vertex once.
    pub(crate) fn in_place(format: Format, numbers: CoordinateEncoding) -> CoordinateStorage {
        CoordinateStorage {
            format,
            encoding: numbers,
            encoded: None,
            repeated_vertices: None,
            file_index: 0,
            says_degrees: None,
            shared_with: None,
        }
    }
}
