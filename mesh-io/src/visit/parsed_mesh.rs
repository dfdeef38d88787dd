//! What the reader of a format returns.

use crate::content::constraints::Constraints;
use crate::content::remark::Remark;
use crate::edit::numbers::{CoordinateEncoding, EncodedArrays, Offsets};
use crate::format::Format;

/// The mesh of a file, with the storage of its coordinates.
pub(crate) struct ParsedMesh {
    pub(crate) format: Format,
    /// x and y of each vertex.
    pub(crate) points: Vec<[f64; 2]>,
    /// The vertices of each triangle.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Offset of each vertex's x in the file that holds the vertices, ascending.
    pub(crate) x_offsets: Offsets,
    /// The vertex of each offset in `x_at`; `None` if there is one for each vertex in order.
    pub(crate) owners: Option<Vec<u32>>,
    /// How the file stores coordinates.
    pub(crate) encoding: CoordinateEncoding,
    /// Which of the files of the mesh holds them, counted from zero.
    pub(crate) file_index: usize,
    /// The points, if they are encoded.
    pub(crate) encoded: Option<Box<dyn EncodedArrays>>,
    /// The region of each triangle; `None` if all are of one.
    pub(crate) regions: Option<Vec<u32>>,
    /// Lines, points and periodic pairs of the file.
    pub(crate) constraints: Constraints,
    pub(crate) remarks: Vec<Remark>,
    /// The names of real numbers that the file gives vertices besides x and y, each once.
    pub(crate) data: Vec<String>,
    /// Whether the file gives vertices parameters on surfaces of a model, at offsets that are known.
    pub(crate) has_parameters: bool,
    /// Whether the file gives elements centers.
    pub(crate) has_centers: bool,
}
