//! The grid of ADCIRC (`fort.14`) and SCHISM (`.gr3`).
//!
//! The format: <https://adcirc.org/home/documentation/users-manual-v53/input-file-descriptions/adcirc-grid-and-boundary-information-file-fort-14/>.
//! Programs read the grid by Fortran's list-directed input: commas may separate numbers, and an item may continue on
//! the next line. The number after x and y is a node's depth. Lists of boundaries at the end of the file are read only
//! for groups. Their nodes, weirs included, are on the boundary of the mesh and stay fixed anyway.

use crate::content::group_label::GroupLabel;
use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::numbered_nodes::numbered_nodes;
use crate::text::cursor::Cursor;
use crate::text::syntax::Syntax;
use crate::visit::items::{CellKind, Element, GroupScope};
use crate::visit::reader::FormatReader;
use crate::visit::rows::{each_row, nodes};
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;

pub(crate) struct Adcirc;

impl FormatReader for Adcirc {
    const VERTICES: &'static str = "the list of nodes";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let cursor = &mut Cursor::new(source).with_syntax(Syntax::FORTRAN);
        // The first line is a title, which may be empty.
        cursor.line();
        cursor.row(0, 1, "lines of counts")?;
        let counts = |cursor: &mut Cursor<'_>| {
            Ok((cursor.integer("the number of elements")?, cursor.vertex_count()?))
        };
        let (elements, count) = cursor.item(counts, &mut None)?;
        let depths = numbered_nodes(cursor, count, false, visitor)?;
        visitor.end_nodes(cursor)?;
        depths.send("depth", CoordinateEncoding::TEXT.into(), visitor);
        visitor.expect_elements(cursor.capacity(elements, "1 3 1 2 3\n".len()));
        each_row(
            cursor,
            elements,
            "elements",
            visitor,
            |cursor| {
                let id = cursor.integer("the number of an element")?;
                let corners = cursor.integer(format_args!("how many nodes element {id} has"))?;
                let Some(kind) = CellKind::of_polygon(corners).filter(|kind| kind.nodes() > 2)
                else {
                    let problem = format!("element {id} has {corners} nodes");
                    return Err(cursor.error(problem, "Elements of three and four nodes are read"));
                };
                Ok(Element { id, kind, region: [0; 2], nodes: nodes(cursor, kind)? })
            },
            |cursor, visitor, _, element| visitor.element(cursor, &element),
        )?;
        if visitor.asks_for_groups() {
            boundaries(cursor, visitor);
        }
        Ok(CoordinateStorage::in_place(Format::Adcirc, CoordinateEncoding::TEXT))
    }
}

/// Visits the boundaries as lines: open boundaries (`open1`), then land boundaries (`land1`), which are named `island1`
/// if their type is that of an island. A damaged list ends the reading without an error, as the mesh does not depend on
/// boundaries.
fn boundaries(cursor: &mut Cursor<'_>, visitor: &mut dyn MeshVisitor) {
    for is_open in [true, false] {
        let Some(count) = number(cursor) else { return };
        // The row has the number of nodes of all boundaries together.
        if !cursor.next_row() {
            return;
        }
        for index in 1..=count {
            let Some(length) = number(cursor) else { return };
            let kind = if is_open { 0 } else { cursor.integer("a type").unwrap_or(0) };
            let word = match (is_open, kind) {
                (true, _) => "open",
                // These types are islands, with different boundary conditions.
                (false, 1 | 11 | 21) => "island",
                _ => "land",
            };
            if kind > 1 {
                visitor.unsupported("types of boundaries, and the data of weirs");
            }
            let mut nodes = Vec::new();
            for _ in 0..length {
                match number(cursor) {
                    Some(node) => nodes.push(node),
                    None => return,
                }
            }
            if word == "island" && !visitor.asks_for_data() {
                // Islands are closed, and need not list their first node a second time.
                nodes.extend(nodes.first().copied());
            }
            let label = GroupLabel::Name(format!("{word}{index}"));
            visitor.group_scopes(&[GroupScope { kind: "boundary", label, dimension: Some(1) }]);
            // A node that does not exist is no reason to refuse the mesh.
            if visitor.polyline(cursor, 0, [0; 2], &nodes).is_err() {
                return;
            }
            visitor.group_scopes(&[]);
        }
    }
}

/// Reads the whole number at the start of the next row; `None` for other rows, or at the end of the file.
fn number(cursor: &mut Cursor<'_>) -> Option<u64> {
    cursor.next_row().then_some(())?;
    cursor.integer("a number").ok()
}
