//! Reads the data lines of `*NODE` and `*ELEMENT`.

use super::blocks::Block;
use super::deck::{ASSEMBLY, Deck};
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::text::parallel_rows::take_rows;
use crate::text::token::integer;
use crate::visit::items::CellKind;
use crate::visit::rows::{all_rows, nodes};
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

/// Moves the cursor to the data lines of a block. Returns a cursor that does not read beyond these lines.
pub(super) fn data_rows<'a>(cursor: &mut Cursor<'a>, block: &Block<'_>) -> Cursor<'a> {
    cursor.seek(block.data.start);
    let mut rows = cursor.clone();
    rows.bytes = &rows.bytes[..block.data.end];
    rows
}

/// Node counts: all nodes, and nodes with a coordinate of more than [`MAX_NUMBER_LENGTH`] characters.
#[derive(Default)]
pub(super) struct LengthCounts {
    pub(super) all: u64,
    pub(super) long: u64,
}

/// Visits the nodes of a block, and adds the nodes to `counted`. `offset` is added to ids. Third coordinates go to `z_values`, ids
/// to `ids` if present.
pub(super) fn send_nodes(
    cursor: &mut Cursor<'_>,
    offset: u64,
    visitor: &mut dyn MeshVisitor,
    z_values: &mut ZValues,
    ids: &mut Option<Vec<u64>>,
    counted: &mut LengthCounts,
) -> Result<(), ReadError> {
    all_rows(cursor, visitor, node, |cursor, visitor, (id, (x_at, is_long), at, z)| {
        let id = id.saturating_add(offset);
        visitor.node(cursor, id, 2, x_at, at);
        z_values.push(z);
        ids.iter_mut().for_each(|ids| ids.push(id));
        counted.all += 1;
        counted.long += u64::from(is_long);
        Ok(())
    })
}

/// A node: the id, (the offset of x, whether x or y exceeds [`MAX_NUMBER_LENGTH`]), x and y, (the offset of z, z).
type Node = (u64, (usize, bool), [f64; 2], (usize, f64));

/// Maximum length of a number in characters. Abaqus and CalculiX ignore all characters beyond this length.
const MAX_NUMBER_LENGTH: usize = 20;

#[inline]
fn node(cursor: &mut Cursor<'_>) -> Result<Node, ReadError> {
    let id = cursor.integer("the number of a node")?;
    let x_at = cursor.at();
    let (mut at, mut is_long) = ([0.0; 2], false);
    for (axis, x) in ['x', 'y'].into_iter().zip(&mut at) {
        if cursor.is_at_end() {
            let problem = format!("{axis} of node {id} is left out, which stands for 0");
            return Err(cursor.error(
                problem,
                "Write the number 0 there, as the field has no room for another value",
            ));
        }
        let start = cursor.at();
        *x = cursor.coordinate(axis, format_args!("node {id}"))?;
        is_long |= cursor.at - start > MAX_NUMBER_LENGTH;
    }
    Ok((id, (x_at, is_long), at, cursor.z_if_any(format_args!("node {id}"))?))
}

/// Reads the elements of a block, and hands the id and nodes of each element to `take`, each plus `offset`. If `ahead`, long lists
/// are parsed on all threads. A failed call of `take` must not change any state: the row is read again to report the error.
pub(super) fn each_element<'a>(
    cursor: &mut Cursor<'a>,
    kind: CellKind,
    offset: u64,
    ahead: bool,
    mut take: impl FnMut(&Cursor<'a>, u64, [u64; 4]) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let mut take = |cursor: &Cursor<'a>, id: u64, mut nodes: [u64; 4]| {
        nodes[..kind.nodes()].iter_mut().for_each(|node| *node = node.saturating_add(offset));
        take(cursor, id.saturating_add(offset), nodes)
    };
    if ahead && cursor.is_long() {
        let nowhere = &Cursor::new(cursor.source);
        let plain = |cursor: &mut Cursor<'a>| {
            let id = cursor.integer(NUMBER)?;
            let nodes = nodes(cursor, kind)?;
            check_row_end(cursor, kind, id)?;
            Ok((id, nodes))
        };
        take_rows(cursor, u64::MAX, plain, |(id, nodes)| take(nowhere, id, nodes).is_ok());
    }
    while cursor.next_row() {
        let id = cursor.integer(NUMBER)?;
        let mut nodes = [0; 4];
        for node in &mut nodes[..kind.nodes()] {
            skip_continuation(cursor);
            *node = cursor.integer(format_args!("a vertex of a {}", kind.name()))?;
        }
        check_row_end(cursor, kind, id)?;
        take(cursor, id, nodes)?;
    }
    Ok(())
}

/// Reads elements of a scope with any number of nodes, and hands the element's id and each node to `take`. In the assembly, only
/// nodes of the mesh's instances are read, written as `Part-1-1.7`; all other nodes are skipped.
pub(super) fn each_constrained<'a>(
    cursor: &mut Cursor<'a>,
    deck: &Deck<'_>,
    scope: usize,
    mut take: impl FnMut(&Cursor<'a>, u64, u64) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    while cursor.next_row() {
        let id = cursor.integer(NUMBER)?;
        loop {
            skip_continuation(cursor);
            if cursor.is_at(b',') {
                // Two adjacent commas stand for a missing node.
                cursor.at = cursor.at();
                continue;
            }
            if cursor.is_at_end() {
                break;
            }
            if scope != ASSEMBLY {
                let node = cursor.integer("a node of an element")?;
                take(cursor, id, node.saturating_add(deck.offset(scope)))?;
                continue;
            }
            let word = cursor.token().unwrap_or_default();
            if let Some(point) = memchr::memchr(b'.', word)
                && let Some(of_mesh) = deck.instance(&word[..point])
                && let Some(node) = integer(&word[point + 1..])
            {
                take(cursor, id, node.saturating_add(deck.offset(of_mesh)))?;
            }
        }
    }
    Ok(())
}

const NUMBER: &str = "the number of an element";

/// Moves to the next row if the current row ends in a comma.
fn skip_continuation(cursor: &mut Cursor<'_>) {
    let at = cursor.at();
    let is_at_end = cursor.bytes.get(at).is_none_or(|&byte| byte == b'\n');
    if is_at_end && cursor.bytes[..at].trim_ascii_end().ends_with(b",") {
        let here = cursor.clone();
        if !cursor.next_row() {
            *cursor = here;
        }
    }
}

/// Checks that a row ends after the nodes of the element.
///
/// # Errors
/// If the row has a further node. Rows of lines always pass, as a beam may have a last node for orientation.
#[inline]
fn check_row_end(cursor: &Cursor<'_>, kind: CellKind, id: u64) -> Result<(), ReadError> {
    if kind == CellKind::Line || cursor.is_at_end() {
        return Ok(());
    }
    let (kind, nodes) = (kind.name(), kind.nodes());
    let problem = format!("{kind} {id} has more nodes than {nodes}");
    Err(cursor.error(problem, "Correct the row, or the TYPE of its *ELEMENT"))
}
