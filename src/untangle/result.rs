//! The progress and the result of an untangling.

use crate::error::BadTriangle;

/// The progress of an [`Untangle`](super::Untangle), for a display.
#[derive(Clone, Copy, Debug)]
pub struct Untangling {
    /// Number of completed sweeps.
    pub sweep: u32,
    /// Number of triangles that are inverted or flat in double precision, among the triangles that the sweep changes.
    pub bad: usize,
}

/// The result of an [`Untangle`](super::Untangle).
#[derive(Clone, Debug)]
pub struct Untangled {
    /// Position of every vertex, in the order and units of the mesh. Fixed vertices keep their coordinates.
    pub points: Vec<[f64; 2]>,
    /// Number of inverted or flat triangles of the given mesh. Triangles too flat for double precision count as flat.
    pub bad_before: usize,
    /// Triangles of the result that are inverted or flat, by exact predicates on `points`. The list is in ascending
    /// order, and empty if the mesh is untangled. Triangles that double precision cannot judge
    /// ([`Smoother::beyond_precision`](crate::Smoother::beyond_precision)) are listed as flat if they have a free
    /// vertex.
    pub left: Vec<BadTriangle>,
    /// Bad triangles of the given mesh without a free vertex, or with two fixed vertices at the same point. No move of
    /// vertices can make such triangles feasible.
    pub hopeless: Vec<BadTriangle>,
    /// A free vertex around which triangles wind more than once, although every triangle is feasible. `None` if there
    /// is no such vertex, or if triangles are left bad.
    pub overlapping: Option<u32>,
    /// Number of completed sweeps, over all starts.
    pub sweeps: u32,
    /// Number of vertices whose coordinates in `points` differ from those of the given mesh.
    pub moved: usize,
}
