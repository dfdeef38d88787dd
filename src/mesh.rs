//! The mesh itself.

/// A 2D triangle mesh: double-precision positions and vertex triples, in the order of their source.
///
/// Nothing about it is checked here: windings may be mixed and vertices unused.
/// [`Topology`](crate::Topology) checks what smoothing needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Position of each vertex, in the units of its source.
    pub points: Vec<[f64; 2]>,
    /// Vertex indices of each triangle, zero-based, in either winding.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices that stay where they are though no boundary holds them: those on constraint lines,
    /// of elements that are not triangles, and between regions. In any order, repeats allowed.
    /// Boundary vertices need not be listed.
    pub fixed: Vec<u32>,
}
