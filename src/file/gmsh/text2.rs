//! The sections of version 2.2: one line per node and per element.

use super::kind::{kind_of, node_tags};
use super::{ahead, row};
use crate::error::ReadError;
use crate::file::heights::Heights;
use crate::file::sink::{Column, Element, Sink};
use crate::file::text::{CORRECT, Cursor};

/// Reads `$Nodes` after its first line. Returns their number.
pub(super) fn nodes(
    cursor: &mut Cursor<'_>,
    heights: &mut Heights,
    sink: &mut dyn Sink,
) -> Result<u64, ReadError> {
    row(cursor, 0, 1, "counts")?;
    let count = cursor.vertex_count()?;
    sink.expect_nodes(cursor.capacity(count, "1 0 0 0\n".len()));
    let plain = ahead(cursor, count, sink, node, |cursor, sink, (tag, (x_at, at), z)| {
        sink.node(cursor, tag, 2, x_at, at);
        heights.see(z);
        true
    });
    for done in plain..count {
        row(cursor, done, count, "nodes")?;
        let (tag, (x_at, at), z) = node(cursor)?;
        sink.node(cursor, tag, 2, x_at, at);
        heights.see(z);
    }
    Ok(count)
}

/// What the first two tags of an element tell.
pub(super) fn columns() -> Vec<Column> {
    ["physical", "entity"].map(Column::tags_from_one).into()
}

/// Reads `$Elements` after its first line. Returns their number.
pub(super) fn elements(cursor: &mut Cursor<'_>, sink: &mut dyn Sink) -> Result<u64, ReadError> {
    row(cursor, 0, 1, "counts")?;
    let count = cursor.integer("the number of elements")?;
    sink.expect_elements(cursor.capacity(count, "1 2 0 1 2 3\n".len()));
    sink.columns(columns());
    let plain = ahead(cursor, count, sink, element, |cursor, sink, element| {
        sink.element(cursor, &element).is_ok()
    });
    for done in plain..count {
        row(cursor, done, count, "elements")?;
        let element = element(cursor)?;
        sink.element(cursor, &element)?;
    }
    Ok(count)
}

/// A node's tag, x and y with the place of x, and z with its own.
type Node = (u64, (usize, [f64; 2]), (usize, f64));

#[inline]
fn node(cursor: &mut Cursor<'_>) -> Result<Node, ReadError> {
    let tag = cursor.integer("a node tag")?;
    let owner = format_args!("node {tag}");
    let point = cursor.point(owner)?;
    Ok((tag, point, cursor.height(owner)?))
}

#[inline]
fn element(cursor: &mut Cursor<'_>) -> Result<Element, ReadError> {
    let tag = cursor.integer("an element tag")?;
    let kind = cursor.integer(format_args!("the type of element {tag}"))?;
    let kind = kind_of(cursor, kind)?;
    let groups = cursor.integer(format_args!("the number of tags of element {tag}"))?;
    let mut region = [0; 2];
    for number in region.iter_mut().take(usize::try_from(groups).unwrap_or(usize::MAX)) {
        *number = cursor.signed(format_args!("a tag of element {tag}"))?;
    }
    // Tags of mesh partitions.
    for _ in 2..groups {
        if cursor.token().is_none() {
            let problem = format!("element {tag} announces {groups} tags, and its line is shorter");
            return Err(cursor.error(problem, CORRECT));
        }
    }
    Ok(Element { tag, kind, region, nodes: node_tags(cursor, kind, tag)? })
}
