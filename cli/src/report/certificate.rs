//! The certificate of a report: what was proved of the written mesh.

use serde::Serialize;

/// A file, and the SHA-256 hash of its bytes as `sha256sum` prints it.
#[derive(Serialize)]
pub(crate) struct FileHash {
    pub(crate) path: String,
    pub(crate) sha256: String,
}

/// What the report says after the written mesh was read again. It rests on the files alone.
#[derive(Serialize)]
pub(crate) struct Certificate {
    /// Whether the files differ in nothing but coordinates and interpolated data.
    pub(crate) connectivity_identical: bool,
    /// Vertices whose coordinates have other bits.
    pub(crate) moved: usize,
    /// Vertices whose coordinates have other bits though they must not move.
    pub(crate) fixed_moved: usize,
    /// Triangles that are inverted or flat, by exact predicates.
    pub(crate) inverted: usize,
    /// The objective by the first metric, of the mesh that was read again.
    pub(crate) f: f64,
    pub(crate) input: Vec<FileHash>,
    pub(crate) output: Vec<FileHash>,
}
