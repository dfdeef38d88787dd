//! The `.mesh` of MIKE (DHI).
//!
//! The format: "MIKE 21 & MIKE 3 Flow Model FM, Mesh File Specification" of DHI, and the reader in DHI's library
//! `mikecore`. The first row contains kind of data, unit, number of nodes and projection; before 2012, only the last
//! two. Nodes have a height and a code: 0 in the interior, 1 on land boundaries, larger codes on open boundaries.

use crate::content::group_label::GroupLabel;
use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::numbered_nodes::numbered_nodes;
use crate::text::cursor::Cursor;
use crate::text::token::{float, integer};
use crate::visit::items::{CellKind, Element};
use crate::visit::reader::FormatReader;
use crate::visit::rows::{each_row, end_of_list, nodes};
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;

pub(crate) struct Mike;

impl FormatReader for Mike {
    const VERTICES: &'static str = "the list of nodes";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let cursor = &mut Cursor::new(source);
        cursor.row(0, 1, "lines of counts")?;
        let mut first = cursor.clone();
        if is_of_2012(&mut first) {
            cursor.tokens(2);
        }
        let count = cursor.vertex_count()?;
        visitor.projection(cursor.rest());
        let before = &mut cursor.clone();
        let z_values = numbered_nodes(cursor, count, false, visitor)?;
        if visitor.asks_for_groups() {
            codes(before, count, visitor)?;
        }
        visitor.end_nodes(cursor)?;
        z_values.send("z", CoordinateEncoding::TEXT.into(), visitor);
        cursor.row(0, 1, "lines of the count of elements")?;
        let elements = cursor.integer("the number of elements")?;
        let most = cursor.integer("the largest number of nodes of an element")?;
        if most > 4 {
            let problem = format!("elements have up to {most} nodes");
            return Err(cursor.error(problem, "Elements of three and four nodes are read"));
        }
        cursor.rest();
        visitor.expect_elements(cursor.capacity(elements, "1 1 2 3\n".len()));
        each_row(cursor, elements, "elements", visitor, element, |cursor, visitor, _, element| {
            visitor.element(cursor, &element)
        })?;
        end_of_list(cursor, elements, "elements", element)?;
        Ok(CoordinateStorage::in_place(Format::Mike, CoordinateEncoding::TEXT))
    }
}

/// Reads an element. In a mesh with quadrilaterals, the fourth node of a triangle is 0.
#[inline]
fn element(cursor: &mut Cursor<'_>) -> Result<Element, ReadError> {
    let id = cursor.integer("the number of an element")?;
    let mut nodes = nodes(cursor, CellKind::Triangle)?;
    if !cursor.is_at_end() {
        nodes[3] = cursor.integer("a vertex of a quadrilateral")?;
    }
    let kind = if nodes[3] == 0 { CellKind::Triangle } else { CellKind::Quadrilateral };
    Ok(Element { id, kind, region: [0; 2], nodes })
}

/// Visits the codes of nodes as groups. Codes follow z in the rows of nodes, and code 0 means no group.
fn codes(
    cursor: &mut Cursor<'_>,
    count: u64,
    visitor: &mut dyn MeshVisitor,
) -> Result<(), ReadError> {
    for node in 0..count {
        cursor.row(node, count, "nodes")?;
        cursor.tokens(4);
        let code = if cursor.is_at_end() { 0 } else { cursor.signed("the code of a node")? };
        if code != 0 {
            visitor.node_group(node as u32, "code", &GroupLabel::Tag(code));
        }
    }
    Ok(())
}

/// Returns whether the first row has the layout since 2012, in which the third number counts the nodes.
fn is_of_2012(row: &mut Cursor<'_>) -> bool {
    (0..3).all(|_| row.token().and_then(integer).is_some())
}

/// Returns whether the first two rows may belong to a MIKE mesh: one or three numbers and a projection, then a node.
pub(crate) fn is_mike(first: &[&[u8]], second: &[&[u8]]) -> bool {
    let numbers = first.iter().take_while(|token| integer(token).is_some()).count();
    let is_projection = |token: &&[u8]| token.first().is_some_and(u8::is_ascii_alphabetic);
    let is_node = || {
        let [id, at @ .., code] = second else { return false };
        at.len() == 3
            && integer(id).is_some()
            && integer(code).is_some()
            && at.iter().all(|token| float(token).is_some())
    };
    matches!(numbers, 1 | 3) && first.get(numbers).is_some_and(is_projection) && is_node()
}
