//! Ghost elements: copies of elements that belong to another piece of a partitioned mesh.

use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::items::Element;
use crate::visit::visitor::MeshVisitor;
use std::collections::HashSet;

/// Smallest bit of `vtkGhostType`: the element or the point belongs to another piece.
const DUPLICATE: f64 = 1.0;

/// Returns whether a number of VTK's array `name` marks a ghost; `None` for names of other arrays.
pub(crate) fn vtk_ghosts(name: &[u8]) -> Option<fn(f64) -> bool> {
    match name.to_ascii_lowercase().as_slice() {
        // Bits. Higher bits mark elements and points that are hidden or on the surface.
        b"vtkghosttype" => Some(|number| number.rem_euclid(2.0 * DUPLICATE) >= DUPLICATE),
        // Before VTK 6.3: the distance to the piece in layers of elements.
        b"vtkghostlevels" => Some(|number| number > 0.0),
        _ => None,
    }
}

/// Visitor of a second reading of the elements, which collects the nodes of some elements.
pub(crate) struct GhostNodes {
    /// Ids of the elements whose nodes are collected.
    ids: HashSet<u64>,
    nodes: Vec<u64>,
}

impl GhostNodes {
    pub(crate) fn of(ids: HashSet<u64>) -> GhostNodes {
        GhostNodes { ids, nodes: Vec::new() }
    }

    /// Passes the nodes of the elements to a visitor. `read` visits the elements of the file.
    ///
    /// # Errors
    /// Those of `read`.
    pub(crate) fn send(
        mut self,
        visitor: &mut dyn MeshVisitor,
        read: impl FnOnce(&mut dyn MeshVisitor) -> Result<(), ReadError>,
    ) -> Result<(), ReadError> {
        if self.ids.is_empty() {
            return Ok(());
        }
        read(&mut self)?;
        visitor.ghosts("ghost element", self.ids.len() as u64, &self.nodes);
        Ok(())
    }
}

impl MeshVisitor for GhostNodes {
    fn node(&mut self, _: &Cursor<'_>, _: u64, _: u64, _: usize, _: [f64; 2]) {}

    fn visit_element(&mut self, _: &Cursor<'_>, element: &Element) -> Result<(), ReadError> {
        if self.ids.contains(&element.id) {
            self.nodes.extend_from_slice(&element.nodes[..element.kind.nodes()]);
        }
        Ok(())
    }
}
