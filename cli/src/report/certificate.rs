//! The certificate of a report: facts proved about the written mesh.

use serde::Serialize;

/// A file and its SHA-256 hash in hexadecimal, as `sha256sum` prints hashes.
#[derive(Serialize)]
pub(crate) struct FileHash {
    pub(crate) path: String,
    pub(crate) sha256: String,
}

/// Facts about the written mesh, proved by reading the input and output files again.
#[derive(Serialize)]
pub(crate) struct Certificate {
    /// Whether the files differ only in coordinates and interpolated data.
    pub(crate) connectivity_identical: bool,
    /// Number of vertices with changed coordinates, compared bit by bit.
    pub(crate) moved: usize,
    /// Number of vertices with changed coordinates among the vertices that must not move.
    pub(crate) fixed_moved: usize,
    /// Number of inverted or flat triangles by exact predicates.
    pub(crate) inverted: usize,
    /// The base metric's objective, evaluated on the mesh from the output file.
    pub(crate) f: f64,
    pub(crate) input: Vec<FileHash>,
    pub(crate) output: Vec<FileHash>,
}
