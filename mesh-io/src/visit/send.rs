//! Passes lists of binary records to a visitor: plain records of long lists in bulk, other records one by one.

use crate::binary::number_field::NumberField;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::items::{CellKind, Element};
use crate::visit::records::{NodeRecords, Region, TriangleRecords};
use crate::visit::visitor::MeshVisitor;

/// Remedy in messages about coordinates that are not finite.
pub(crate) const REWRITE: &str = "Write the mesh again";

impl NodeRecords<'_> {
    /// Passes all nodes to the visitor. The fields must hold `count` records. For a node's index, `place` returns a
    /// cursor at the node, and `not_finite` the error for a coordinate that is not finite.
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

/// Binary list of elements of one kind; each record holds the node ids of an element.
pub(crate) struct ElementRecords<'a> {
    pub(crate) kind: CellKind,
    pub(crate) count: usize,
    /// Id of the first element; ids are consecutive.
    pub(crate) first_tag: u64,
    /// Field of the adjacent node ids of each element.
    pub(crate) nodes: NumberField<'a>,
    /// Whether node ids are signed. Negative ids become 0, an id without a node.
    pub(crate) is_signed: bool,
    pub(crate) regions: [Region<'a>; 2],
}

impl ElementRecords<'_> {
    /// Passes all elements to the visitor. The fields must hold `count` records. For an element's index, `place`
    /// returns a cursor at the element, and may announce the element's groups to the visitor before.
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
