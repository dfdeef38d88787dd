//! The mesh that a caller supplies.

/// A 2D triangle mesh: double-precision positions and vertex triples, in the order of their file or application.
///
/// Nothing about it is checked here: windings may be mixed and vertices unused.
/// [`Topology`](crate::Topology) checks what smoothing needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Position of each vertex, in any unit.
    pub points: Vec<[f64; 2]>,
    /// Vertex indices of each triangle, zero-based, in either winding.
    pub triangles: Vec<[u32; 3]>,
    /// Interior vertices that must not move: those on constraint lines, of elements that are not triangles,
    /// and between regions. In any order, repeats allowed. Boundary vertices never move and need not be listed.
    pub fixed: Vec<u32>,
}
