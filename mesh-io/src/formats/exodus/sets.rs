//! Side sets and node sets of an Exodus file.

use super::blocks::Block;
use super::{File, NO_BLOCK};
use crate::content::group_label::GroupLabel;
use crate::error::ReadError;
use crate::text::cursor::{CORRECT, Cursor};
use crate::visit::items::{CellKind, Element, GroupScope};
use crate::visit::visitor::MeshVisitor;

impl File<'_> {
    /// Visits the sides of triangles and quadrilaterals in side sets as lines.
    ///
    /// # Errors
    /// If a side set has lists of different lengths, or names a side that does not exist.
    pub(super) fn side_sets(
        &self,
        blocks: &[Block<'_>],
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(), ReadError> {
        let ids = self.named("sideset", ["ss_prop1", "ss_names"], 1, visitor);
        for (number, elements) in self.header.numbered("elem_ss") {
            let sides = self.header.variable(&format!("side_ss{number}"));
            let start = self.header.start_of(elements);
            let cursor = Cursor::at_byte_offset(self.source, start);
            let found = sides.filter(|sides| !sides.is_record && !elements.is_record);
            let lists = found.and_then(|sides| {
                Some((self.header.integers(elements)?, self.header.integers(sides)?))
            });
            let Some((elements, sides)) = lists.filter(|(a, b)| a.len() == b.len()) else {
                let problem =
                    format!("side set {number} does not have one side for each of its elements");
                return Err(cursor.error(problem, CORRECT));
            };
            let label = GroupLabel::Tag(self.id(&ids, number));
            visitor.group_scopes(&[GroupScope { kind: "sideset", label, dimension: Some(1) }]);
            for (&element, &side) in elements.iter().zip(&sides) {
                let Some(ends) = self.side(blocks, element, side) else {
                    let problem = format!("side set {number} has side {side} of element {element}");
                    return Err(cursor.error(problem, "There is no such side: correct the set"));
                };
                let Some([a, b]) = ends else {
                    visitor.unsupported("sides of side sets that are no edges");
                    continue;
                };
                let (kind, nodes) = (CellKind::Line, [a, b, 0, 0]);
                // Sides have no number of their own.
                let line = Element { id: 0, kind, region: [NO_BLOCK, 0], nodes };
                visitor.element(&cursor, &line)?;
            }
        }
        visitor.group_scopes(&[]);
        Ok(())
    }

    /// Returns the nodes at the ends of a side, both numbers counted from 1. `Some(None)` if the side is not an edge: a
    /// face of a shell, or a side of a bar or sphere. `None` if the element or side does not exist.
    fn side(&self, blocks: &[Block<'_>], element: i64, side: i64) -> Option<Option<[u64; 2]>> {
        let place = u64::try_from(element).ok()?.checked_sub(1)?;
        let block = &blocks[blocks.partition_point(|block| block.before + block.count <= place)..];
        let block = block.first()?;
        let mut side = usize::try_from(side).ok()?.checked_sub(1)?;
        if block.has_sides_of_faces {
            match side.checked_sub(2) {
                None => return Some(None),
                Some(edge) => side = edge,
            }
        }
        let corners = match block.kind {
            CellKind::Triangle | CellKind::Quadrilateral => block.kind.nodes(),
            _ => return Some(None),
        };
        let (nodes, _) = block.element(place - block.before);
        (side < corners).then(|| Some([nodes[side], nodes[(side + 1) % corners]]))
    }

    /// Visits the nodes of all node sets.
    ///
    /// # Errors
    /// If a node set names a node that does not exist.
    pub(super) fn node_sets(&self, visitor: &mut dyn MeshVisitor) -> Result<(), ReadError> {
        let ids = self.named("nodeset", ["ns_prop1", "ns_names"], 0, visitor);
        for (number, variable) in self.header.numbered("node_ns") {
            let header = &self.header;
            let nodes = if variable.is_record { None } else { header.integers(variable) };
            let id = self.id(&ids, number);
            for node in nodes.unwrap_or_default() {
                let index = node.checked_sub(1).and_then(|index| u32::try_from(index).ok());
                let index = index.filter(|&i| (i as usize) < self.nodes);
                let Some(index) = index else {
                    let cursor = Cursor::at_byte_offset(self.source, header.start_of(variable));
                    let problem = format!("node set {number} has node {node}");
                    return Err(cursor.error(problem, "There is no such node: correct the set"));
                };
                visitor.node_group(index, "nodeset", &GroupLabel::Tag(id));
            }
        }
        Ok(())
    }

    /// Visits the names of all side sets (dimension 1) or node sets (dimension 0). Returns the ids of the sets.
    fn named(
        &self,
        what: &str,
        [numbers, names]: [&str; 2],
        dimension: u8,
        visitor: &mut dyn MeshVisitor,
    ) -> Vec<i64> {
        let ids = self.ids(numbers);
        if let (true, Some(names)) = (visitor.asks_for_groups(), self.header.variable(names)) {
            for (name, &id) in self.header.texts(names).iter().zip(&ids) {
                if !name.is_empty() {
                    visitor.group_name(what, Some(dimension), id, name);
                }
            }
        }
        ids
    }
}
