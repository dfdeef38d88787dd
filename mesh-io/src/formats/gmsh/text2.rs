//! Sections of versions 1 and 2.2 as text, with a line for each node and element.

use super::encoding::Version;
use super::kind::{kind_of, node_tags};
use super::lists::{counts, each, note_partitions};
use super::repeats::ElementSender;
use super::words::Progress;
use crate::error::ReadError;
use crate::text::cursor::{CORRECT, Cursor};
use crate::visit::items::{Element, RegionAttribute};
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

/// Reads `$Nodes` or `$NOD` after its first line. Returns the number of nodes.
pub(super) fn nodes(
    cursor: &mut Cursor<'_>,
    z_values: &mut ZValues,
    visitor: &mut dyn MeshVisitor,
) -> Result<u64, ReadError> {
    let count = counts(cursor, Cursor::vertex_count, |count| count)?;
    visitor.expect_nodes(cursor.capacity(count, "1 0 0 0\n".len()));
    let progress = Progress::new(0, count, "nodes");
    each(
        cursor,
        count,
        progress,
        visitor,
        |cursor, _| node(cursor),
        |cursor, visitor, _, (tag, (x_at, at), z)| {
            visitor.node(cursor, tag, 2, x_at, at);
            z_values.push(z);
            Ok(())
        },
    )?;
    Ok(count)
}

/// Returns the meaning of an element's first two tags: physical group and entity, with 0 for none.
pub(super) fn columns() -> Vec<RegionAttribute> {
    ["physical", "entity"].map(RegionAttribute::tags_from_one).into()
}

/// Reads `$Elements` or `$ELM` after its first line. Returns the number of elements.
pub(super) fn elements(
    cursor: &mut Cursor<'_>,
    version: Version,
    visitor: &mut dyn MeshVisitor,
) -> Result<u64, ReadError> {
    let read = |cursor: &mut Cursor<'_>| cursor.integer("the number of elements");
    let count = counts(cursor, read, |count| count)?;
    visitor.expect_elements(cursor.capacity(count, "1 2 0 1 2 3\n".len()));
    visitor.region_attributes(columns());
    let progress = Progress::new(0, count, "elements");
    let read = |cursor: &mut Cursor<'_>, _| element(cursor, version);
    let mut elements = ElementSender::default();
    each(
        cursor,
        count,
        progress,
        visitor,
        read,
        |cursor, visitor, _, (element, has_partitions)| {
            if has_partitions {
                note_partitions(visitor);
            }
            elements.send(cursor, visitor, &element)
        },
    )?;
    Ok(count)
}

/// Tag of a node, offset of x with x and y, and offset of z with z.
type Node = (u64, (usize, [f64; 2]), (usize, f64));

#[inline]
fn node(cursor: &mut Cursor<'_>) -> Result<Node, ReadError> {
    let tag = cursor.integer("a node tag")?;
    let point = cursor.point(format_args!("node {tag}"))?;
    Ok((tag, point, cursor.z(format_args!("node {tag}"))?))
}

/// Reads the row of an element. Returns the element, and whether it has partitions. In version 1, the two tags stand without
/// their number, and the number of nodes precedes the nodes.
#[inline]
fn element(cursor: &mut Cursor<'_>, version: Version) -> Result<(Element, bool), ReadError> {
    let tag = cursor.integer("an element tag")?;
    let kind = cursor.integer(format_args!("the type of element {tag}"))?;
    let kind = kind_of(cursor, kind)?;
    if version == Version::V1 {
        let mut region = [0; 2];
        for number in &mut region {
            *number = cursor.signed(format_args!("a tag of element {tag}"))?;
        }
        let count = cursor.integer(format_args!("the number of nodes of element {tag}"))?;
        if count != kind.nodes() as u64 {
            let problem = format!("element {tag} is a {} of {count} nodes", kind.name());
            return Err(cursor.error(problem, CORRECT));
        }
        let nodes = node_tags(cursor, kind, tag)?;
        return Ok((Element { id: tag, kind, region, nodes }, false));
    }
    let groups = cursor.integer(format_args!("the number of tags of element {tag}"))?;
    let mut region = [0; 2];
    for number in region.iter_mut().take(usize::try_from(groups).unwrap_or(usize::MAX)) {
        *number = cursor.signed(format_args!("a tag of element {tag}"))?;
    }
    // Tags after the second list mesh partitions, or have zeros.
    let mut has_partitions = false;
    for _ in 2..groups {
        let Some(token) = cursor.token() else {
            let problem = format!("element {tag} announces {groups} tags, but its line has fewer");
            return Err(cursor.error(problem, CORRECT));
        };
        has_partitions |= token != b"0";
    }
    let nodes = node_tags(cursor, kind, tag)?;
    Ok((Element { id: tag, kind, region, nodes }, has_partitions))
}
