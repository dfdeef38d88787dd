//! Elements in several physical groups, which version 2 lists once for each group.

use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::items::{CellKind, Element};
use crate::visit::visitor::MeshVisitor;

/// Passes elements to a visitor. Successive rows with the same nodes and entity but different physical groups are one
/// element: gmsh writes a row for each group, with a tag of its own.
#[derive(Default)]
pub(super) struct ElementSender {
    last: Option<Row>,
}

struct Row {
    kind: CellKind,
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
        let &Element { kind, nodes, region: [physical, entity], .. } = element;
        let is_further = self.last.as_ref().is_some_and(|last| {
            last.nodes == nodes
                && last.kind == kind
                && last.region[1] == entity
                && last.region[0] != physical
        });
        match is_further {
            // The element is in the group of its entity already.
            true => visitor.further_region(kind, [physical, 0]),
            false => visitor.element(cursor, element)?,
        }
        self.last = Some(Row { kind, nodes, region: element.region });
        Ok(())
    }

    /// Forgets the last element, after elements that the visitor has taken itself.
    pub(super) fn forget(&mut self) {
        self.last = None;
    }
}

/// Returns whether adjacent records of `size` bytes have equal bytes from `start` to `end`.
pub(super) fn has_equal_neighbors(block: &[u8], size: usize, start: usize, end: usize) -> bool {
    let mut nodes = block.chunks_exact(size).map(|record| &record[start..end]);
    let mut last = nodes.next();
    nodes.any(|nodes| last.replace(nodes) == Some(nodes))
}
