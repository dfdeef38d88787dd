//! Hands lists of binary records to a visitor: plain records of a long list at once, others one by one.

use crate::binary::number_field::NumberField;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::items::{CellKind, Element};
use crate::visit::records::{NodeRecords, Region, TriangleRecords};
use crate::visit::visitor::MeshVisitor;

/// The remedy for a coordinate that is not a finite number.
pub(crate) const REWRITE: &str = "Write the mesh again";

impl NodeRecords<'_> {
    /// Hands on all nodes. The fields must hold them. `place` returns the location of a node by its
    /// index, and `not_finite` the error if a coordinate of the node is not a finite number.
    pub(crate) fn send<'c>(
        &self,
        visitor: &mut dyn MeshVisitor,
        place: impl Fn(usize) -> Cursor<'c>,
        not_finite: impl Fn(usize) -> ReadError,
    ) -> Result<(), ReadError> {
        let &NodeRecords { count, x, y, x_offset: x_at, ids } = self;
        visitor.expect_nodes(count);
        for index in visitor.node_records(self)..count {
            let at = [x, y].map(|field| field.real_at(index));
            if !at.iter().all(|x| x.is_finite()) {
                return Err(not_finite(index));
            }
            let x_at = x_at + index * x.stride();
            visitor.node(&place(index), ids.of(index), 2, x_at, at);
        }
        Ok(())
    }
}

/// A list of elements of one kind, of which each record has the nodes of an element.
pub(crate) struct ElementRecords<'a> {
    pub(crate) kind: CellKind,
    pub(crate) count: usize,
    /// The id of the first element. Tags are consecutive.
    pub(crate) first_tag: u64,
    /// The ids of an element's nodes, side by side.
    pub(crate) nodes: NumberField<'a>,
    /// Whether ids of nodes are signed. A negative id becomes 0, which no node has.
    pub(crate) is_signed: bool,
    pub(crate) regions: [Region<'a>; 2],
}

impl ElementRecords<'_> {
    /// Hands on all elements. The fields must hold them. `place` returns the location of an element by its index, and may tell
    /// the visitor before which groups the element belongs to.
    pub(crate) fn send<'c>(
        &self,
        visitor: &mut dyn MeshVisitor,
        mut place: impl FnMut(usize, &mut dyn MeshVisitor) -> Cursor<'c>,
    ) -> Result<(), ReadError> {
        let &ElementRecords { kind, count, nodes: corners, regions, .. } = self;
        let mut taken = 0;
        if kind == CellKind::Triangle {
            visitor.expect_elements(count);
            let (first, below, expected) = (0, u64::MAX, &[][..]);
            let records = TriangleRecords {
                count,
                nodes: corners,
                min_node: first,
                node_end: below,
                regions,
                required_fields: expected,
            };
            taken = visitor.triangle_records(&records);
        }
        if taken == count {
            return Ok(());
        }
        for (index, bytes) in (taken..count).zip(corners.of(taken..count)) {
            let mut nodes = [0; 4];
            let own = nodes[..kind.nodes()].iter_mut().zip(bytes.chunks_exact(corners.width));
            for (node, bytes) in own {
                *node = match self.is_signed {
                    true => u64::try_from(corners.order.signed(bytes)).unwrap_or(0),
                    false => corners.order.whole(bytes),
                };
            }
            let region = regions.map(|region| region.of(index));
            let id = self.first_tag.saturating_add(index as u64);
            let cursor = place(index, visitor);
            visitor.element(&cursor, &Element { id, kind, region, nodes })?;
        }
        Ok(())
    }
}
