//! The mesh that a caller supplies, its elements by number, and its size.

use std::fmt;

/// A 2D mesh of triangles and quadrilaterals: double-precision positions and the vertices of each element, in the order of
/// their file or application.
///
/// The struct checks nothing: elements may have either winding, and vertices may be unused.
/// [`Topology`](crate::Topology) checks the properties that smoothing needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Position of each vertex, in any unit.
    pub points: Vec<[f64; 2]>,
    /// Vertex indices of each triangle, zero-based, in either winding.
    pub triangles: Vec<[u32; 3]>,
    /// Vertex indices of each quadrilateral, zero-based, around it in either direction.
    pub quadrilaterals: Vec<[u32; 4]>,
    /// Vertices that must not move: vertices on constraint lines, between regions, or of elements of other kinds.
    /// Any order, repeats allowed. Boundary vertices move only if they slide, and a listed boundary vertex does not slide
    /// along the boundary; see [`Slide::lines`](crate::Slide::lines).
    pub fixed: Vec<u32>,
}

impl Mesh {
    /// Returns the numbers of vertices and of triangles, with four triangles for each quadrilateral.
    pub fn size(&self) -> MeshSize {
        let triangles = self.triangles.len() + 4 * self.quadrilaterals.len();
        MeshSize { vertices: self.points.len(), triangles }
    }
}

/// A triangle or a quadrilateral of a [`Mesh`], by its index in the list of triangles or quadrilaterals. `Display` writes kind
/// and index, such as "quadrilateral 7".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Element {
    /// Index in [`Mesh::triangles`].
    Triangle(usize),
    /// Index in [`Mesh::quadrilaterals`].
    Quadrilateral(usize),
}

impl Element {
    /// Returns the index in [`Mesh::triangles`] or [`Mesh::quadrilaterals`].
    pub fn index(self) -> usize {
        match self {
            Self::Triangle(index) | Self::Quadrilateral(index) => index,
        }
    }
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Triangle(index) => write!(f, "triangle {index}"),
            Self::Quadrilateral(index) => write!(f, "quadrilateral {index}"),
        }
    }
}

/// Size of a mesh, for [`Backend::auto`](crate::Backend::auto), `Gpu::required_limits` and `Gpu::check_size`.
/// [`Mesh::size`] returns the size of a mesh. An application that does not know its meshes yet passes the largest size
/// that it expects: for up to n vertices 2 n triangles, or 4 n if the meshes may have quadrilaterals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshSize {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles. A quadrilateral counts as four, one for each corner.
    pub triangles: usize,
}
