//! The grid of ADCIRC (`fort.14`) and SCHISM (`.gr3`).
//!
//! The format: <https://adcirc.org/home/documentation/users-manual-v53/input-file-descriptions/adcirc-grid-and-boundary-information-file-fort-14/>.
//! Programs read the grid by Fortran's list-directed input: commas may separate numbers, and an item may continue on
//! the next line. The number after x and y is a node's depth. Lists of boundaries at the end of the file are read for
//! groups and for the pairs of nodes of weirs, and to find files that are cut off. Their nodes are on the boundary of the mesh and stay fixed anyway.

use crate::content::group_label::GroupLabel;
use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::numbered_nodes::numbered_nodes;
use crate::text::cursor::{CORRECT, CUT_OFF, Cursor};
use crate::text::syntax::Syntax;
use crate::visit::items::{CellKind, Element, GroupScope};
use crate::visit::reader::FormatReader;
use crate::visit::rows::{each_row, end_of_list, nodes};
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
        each_row(cursor, elements, "elements", visitor, element, |cursor, visitor, _, element| {
            visitor.element(cursor, &element)
        })?;
        // The number of boundaries follows. An element would have the next number.
        end_of_list(cursor, elements, "elements", |cursor| match element(cursor)? {
            Element { id, .. } if id == elements + 1 => Ok(()),
            _ => Err(cursor.error("a boundary", CORRECT)),
        })?;
        boundaries(cursor, visitor)?;
        Ok(CoordinateStorage::in_place(Format::Adcirc, CoordinateEncoding::TEXT))
    }
}

/// Reads an element: its number, its kind and its nodes.
fn element(cursor: &mut Cursor<'_>) -> Result<Element, ReadError> {
    let id = cursor.integer("the number of an element")?;
    let corners = cursor.integer(format_args!("how many nodes element {id} has"))?;
    let Some(kind) = CellKind::of_polygon(corners).filter(|kind| kind.nodes() > 2) else {
        let problem = format!("element {id} has {corners} nodes");
        return Err(cursor.error(problem, "Elements of three and four nodes are read"));
    };
    let nodes = nodes(cursor, kind)?;
    // Some programs write four nodes in every row, and 0 as the fourth node of a triangle. Nodes count from 1.
    let kind = if nodes[3] == 0 { CellKind::Triangle } else { kind };
    Ok(Element { id, kind, region: [0; 2], nodes })
}

/// Visits the boundaries as lines: open boundaries (`open1`), then land boundaries (`land1`), which are named `island1`
/// if their type is that of an island. A weir has the lines of both banks, and its pairs of nodes are visited. A grid may
/// end without boundaries, or have other text after its elements.
///
/// # Errors
/// If the file ends within the boundaries, if a number is no number, or if a further land boundary follows the last one.
fn boundaries(cursor: &mut Cursor<'_>, visitor: &mut dyn MeshVisitor) -> Result<(), ReadError> {
    for is_open in [true, false] {
        let side = if is_open { "open" } else { "land" };
        let mut next = cursor.clone();
        if !next.next_row() {
            return Ok(());
        }
        let Ok(count) = next.integer("the number of boundaries") else { return Ok(()) };
        *cursor = next;
        // The row has the number of nodes of all boundaries together.
        if !cursor.next_row() && count > 0 {
            let problem =
                format!("the file ends before the nodes of its {count} {side} boundaries");
            return Err(cursor.error(problem, CUT_OFF));
        }
        let what = format!("{side} boundaries");
        for index in 1..=count {
            cursor.row(index - 1, count, &what)?;
            let length = cursor.integer(format_args!("the length of {side} boundary {index}"))?;
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
            // Types of weirs, pipes and vertical walls inside of the mesh (NBVV with IBCONN).
            let is_weir = matches!(kind, 4 | 24 | 5 | 25 | 64);
            let what = format!("nodes of {side} boundary {index}");
            let Bank { mut nodes, pairs } = bank(cursor, length, is_weir, &what)?;
            if word == "island" && !visitor.asks_for_data() {
                // Islands are closed, and need not list their first node a second time.
                nodes.extend(nodes.first().copied());
            }
            visitor.weir(&pairs);
            let name = format!("{word}{index}");
            // A node that does not exist is no reason to refuse the mesh, which does not depend on boundaries.
            if visitor.asks_for_groups() && lines(cursor, visitor, name, &nodes, &pairs).is_err() {
                return Ok(());
            }
        }
        if !is_open && count > 0 {
            // Other programs may write text or single numbers behind the land boundaries.
            end_of_list(cursor, count, "land boundaries", |cursor| {
                let length = cursor.integer("a length")?;
                cursor.integer("a type")?;
                cursor.row(0, 1, "nodes")?;
                match length {
                    0 => Err(cursor.error("no boundary", CORRECT)),
                    _ => cursor.integer("a node"),
                }
            })?;
        }
    }
    Ok(())
}

/// The nodes of a boundary. For a weir, `pairs` has each node with the node that faces it on the other bank.
struct Bank {
    nodes: Vec<u64>,
    pairs: Vec<[u64; 2]>,
}

/// Reads the nodes of a boundary, one in each row. `what` names the nodes in errors.
fn bank(
    cursor: &mut Cursor<'_>,
    length: u64,
    is_weir: bool,
    what: &str,
) -> Result<Bank, ReadError> {
    let mut bank = Bank { nodes: Vec::new(), pairs: Vec::new() };
    for done in 0..length {
        cursor.row(done, length, what)?;
        let node = cursor.integer(format_args!("one of the {what}"))?;
        bank.nodes.push(node);
        if is_weir {
            let other = cursor.integer(format_args!("the other node of one of the {what}"))?;
            bank.pairs.push([node, other]);
        }
    }
    Ok(bank)
}

/// Visits the lines of a boundary: its nodes, and for a weir the nodes on the other bank.
///
/// # Errors
/// If a node does not exist, which is no reason to refuse the mesh.
fn lines(
    cursor: &Cursor<'_>,
    visitor: &mut dyn MeshVisitor,
    name: String,
    nodes: &[u64],
    pairs: &[[u64; 2]],
) -> Result<(), ReadError> {
    let label = GroupLabel::Name(name);
    visitor.group_scopes(&[GroupScope { kind: "boundary", label, dimension: Some(1) }]);
    visitor.polyline(cursor, 0, [0; 2], nodes)?;
    let other: Vec<u64> = pairs.iter().map(|&[_, other]| other).collect();
    if !other.is_empty() {
        visitor.polyline(cursor, 0, [0; 2], &other)?;
    }
    visitor.group_scopes(&[]);
    Ok(())
}
