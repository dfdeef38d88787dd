//! The mesh that a caller supplies, and its size.

/// A 2D triangle mesh: double-precision positions and vertex triples, in the order of their file or application.
///
/// The struct checks nothing: triangles may have either winding, and vertices may be unused.
/// [`Topology`](crate::Topology) checks the properties that smoothing needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Position of each vertex, in any unit.
    pub points: Vec<[f64; 2]>,
    /// Vertex indices of each triangle, zero-based, in either winding.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices that must not move: vertices on constraint lines, between regions, or of elements that are not triangles.
    /// Any order, repeats allowed. Boundary vertices move only if they slide, and a listed boundary vertex does not slide
    /// along the boundary; see [`Slide::lines`](crate::Slide::lines).
    pub fixed: Vec<u32>,
}

impl Mesh {
    /// Returns the numbers of vertices and triangles.
    pub fn size(&self) -> MeshSize {
        MeshSize { vertices: self.points.len(), triangles: self.triangles.len() }
    }
}

/// Size of a mesh, for [`Backend::auto`](crate::Backend::auto), `Gpu::required_limits` and `Gpu::check_size`.
/// [`Mesh::size`] returns the size of a mesh. An application that does not know its meshes yet passes the largest size
/// that it expects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshSize {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
}
