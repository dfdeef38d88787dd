//! Elements in several physical groups, which version 2 lists once for each group.

use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::items::{CellKind, Element};
use crate::visit::visitor::MeshVisitor;

/// Passes elements to a visitor. Successive rows with the same nodes and entity but different physical groups are one
/// element: gmsh writes a row for each group, with a tag of its own.
#[derive(Default)]
pub(super) struct ElementSender {
    /// Kind of the last element; `None` before the first one.
    kind: Option<CellKind>,
    nodes: [u64; 4],
    region: [i64; 2],
}

impl ElementSender {
    /// Visits an element, or a further group of the element before.
    ///
    /// # Errors
    /// If the visitor refuses the element.
    #[inline]
    pub(super) fn send(
        &mut self,
        cursor: &Cursor<'_>,
        visitor: &mut dyn MeshVisitor,
        element: &Element,
    ) -> Result<(), ReadError> {
        // Most elements differ in their first nodes, and need no further comparison.
        match element.nodes[0] == self.nodes[0] && self.is_repeated(element) {
            // The element is in the group of its entity already.
            true => {
                let kind =
                    element.triangle_of_four().map_or(element.kind, |triangle| triangle.kind);
                visitor.further_region(kind, [element.region[0], 0]);
            }
            false => visitor.element(cursor, element)?,
        }
        (self.kind, self.nodes, self.region) = (Some(element.kind), element.nodes, element.region);
        Ok(())
    }

    #[cold]
    fn is_repeated(&self, element: &Element) -> bool {
        let &Element { kind, nodes, region: [physical, entity], .. } = element;
        let [last_physical, last_entity] = self.region;
        self.kind == Some(kind)
            && self.nodes == nodes
            && last_entity == entity
            && last_physical != physical
    }

    /// Forgets the last element, after elements that the visitor has taken itself.
    pub(super) fn forget(&mut self) {
        self.kind = None;
    }
}

/// Returns whether adjacent records of `size` bytes have equal bytes from `start` to `end`, at least four bytes.
pub(super) fn has_equal_neighbors(block: &[u8], size: usize, start: usize, end: usize) -> bool {
    let mut nodes = block.chunks_exact(size).map(|record| &record[start..end]);
    let Some(mut last) = nodes.next() else { return false };
    // Most records differ in their first bytes, whose comparison is no call.
    nodes.any(|nodes| {
        let before = std::mem::replace(&mut last, nodes);
        nodes.first_chunk::<4>() == before.first_chunk() && nodes == before
    })
}
