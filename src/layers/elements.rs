//! The elements of a mesh among which layers are searched.

use std::borrow::Cow;

use crate::error::MeshError;
use crate::topology::Topology;

/// The elements of a mesh among which layers are searched.
#[derive(Clone, Copy, Debug)]
pub struct Elements<'m> {
    /// The triangles, and quadrilaterals that may move.
    pub topology: &'m Topology<'m>,
    /// Positions of the vertices, in any unit.
    pub points: &'m [[f64; 2]],
    /// Quadrilaterals and larger faces as vertex indices, of either winding, that are no elements of the topology.
    pub faces: &'m [Vec<u32>],
    /// Edges inside the mesh that are walls: named lines, and edges between regions. Edges of the boundary are walls
    /// without a list.
    pub lines: &'m [[u32; 2]],
}

impl Elements<'_> {
    /// Returns the faces: quadrilaterals of the mesh, and the given faces.
    pub(super) fn all_faces(&self) -> Cow<'_, [Vec<u32>]> {
        match self.topology.quadrilaterals().len() {
            0 => Cow::Borrowed(self.faces),
            _ => {
                let of_mesh = self.topology.quadrilaterals().map(Vec::from);
                of_mesh.chain(self.faces.iter().cloned()).collect()
            }
        }
    }

    /// Checks that all elements, lines and walls name vertices that have points.
    pub(super) fn check(&self, walls: Option<&[u32]>) -> Result<(), MeshError> {
        self.topology.check_count(self.points)?;
        let vertices = self.points.len();
        let faces = self.faces.iter().flatten();
        let named = faces.chain(self.lines.as_flattened()).chain(walls.into_iter().flatten());
        match named.copied().find(|&v| v as usize >= vertices) {
            Some(vertex) => Err(MeshError::IndexOutOfRange { element: None, vertex, vertices }),
            None => Ok(()),
        }
    }
}
