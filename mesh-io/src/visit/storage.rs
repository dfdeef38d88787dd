//! How and where a file stores coordinates and other numbers, known after it was read.

use crate::edit::numbers::{Encoded, Form, Numbers, Places};
use crate::format::Format;
use std::sync::Arc;

/// Where the numbers of an array stand.
pub(crate) struct Stored {
    pub(crate) places: Places,
    pub(crate) form: Form,
    pub(crate) home: Home,
    /// Which file of the mesh that is.
    pub(crate) part: usize,
}

impl Stored {
    /// Makes the value for numbers that stand in the file itself.
    pub(crate) fn in_place(places: Places, form: Form) -> Option<Stored> {
        Some(Stored { places, form, home: Home::File, part: 0 })
    }
}

/// The bytes that the places of numbers refer to.
pub(crate) enum Home {
    File,
    /// The decoded bytes of the encoded points.
    Points,
    /// Those of an array that is encoded itself, perhaps with other arrays.
    Encoded(Arc<dyn Encoded>),
}

/// How a file stores its numbers, known after it was read.
pub(crate) struct Layout {
    pub(crate) format: Format,
    pub(crate) numbers: Numbers,
    /// The encoded points, if they are encoded. The offsets of coordinates are then those in its decoded bytes.
    pub(crate) encoded: Option<Box<dyn Encoded>>,
    /// Where the coordinates stand, if a vertex may have them in several places.
    pub(crate) copies: Option<Copies>,
    /// The index of the file that has the coordinates, in the order of [`Source::parts`](crate::disk::source::Source::parts).
    pub(crate) part: usize,
}

/// All places of coordinates in a file that repeats vertices.
pub(crate) struct Copies {
    /// The offset of each x, ascending.
    pub(crate) x_at: Vec<usize>,
    /// The index of each x's vertex.
    pub(crate) vertices: Vec<u32>,
}

impl Layout {
    /// Makes the layout of a file that has its coordinates in place.
    pub(crate) fn in_place(format: Format, numbers: Numbers) -> Layout {
        Layout { format, numbers, encoded: None, copies: None, part: 0 }
    }
}
