//! The sections of version 4.1: blocks, one per entity of the model.

use super::kind::{kind_of, node_tags};
use super::model::Model;
use super::{Version, ahead, all_in_blocks, block_fits, row};
use crate::error::ReadError;
use crate::file::heights::{Heights, TextNumbers};
use crate::file::sink::{Element, Sink};
use crate::file::text::Cursor;
use crate::mesh::Precision;
use std::fmt::Display;

/// Reads `$Nodes` after its first line. Returns their number.
pub(super) fn nodes(
    cursor: &mut Cursor<'_>,
    heights: &mut Heights,
    sink: &mut dyn Sink,
) -> Result<u64, ReadError> {
    row(cursor, 0, 1, "counts")?;
    let blocks = cursor.integer("the number of node blocks")?;
    let count = cursor.vertex_count()?;
    sink.expect_nodes(cursor.capacity(count, "1\n0 0 0\n".len()));
    let mut done = 0;
    let mut tags = Vec::new();
    for block in 0..blocks {
        row(cursor, block, blocks, "node blocks")?;
        let dimension = cursor.integer("the dimension of a node block")?;
        let entity = cursor.signed("the entity of a node block").unwrap_or(0);
        let parametric = cursor.integer("whether the nodes are parametric")? != 0;
        let wanted = parametric && dimension == 2 && super::has_parameters(sink, entity);
        let size = cursor.integer("the number of nodes of a block")?;
        block_fits(cursor, size, count - done, "nodes")?;
        tags.clear();
        tags.reserve(cursor.capacity(size, "1\n0 0 0\n".len()));
        let plain = ahead(cursor, size, sink, node_tag, |_, _, tag| {
            tags.push(tag);
            true
        });
        for at in plain..size {
            row(cursor, done + at, count, "node tags")?;
            tags.push(node_tag(cursor)?);
        }
        let before = cursor.clone();
        let mut owners = tags.iter();
        let read = |cursor: &mut Cursor<'_>| point(cursor, "a node");
        let plain = ahead(cursor, size, sink, read, |cursor, sink, ((x_at, at), z)| {
            heights.see(z);
            let owner = owners.next();
            owner.inspect(|&&tag| sink.node(cursor, tag, dimension, x_at, at)).is_some()
        });
        for (at, &tag) in (plain..).zip(owners) {
            row(cursor, done + at, count, "nodes")?;
            let ((x_at, at), z) = point(cursor, format_args!("node {tag}"))?;
            sink.node(cursor, tag, dimension, x_at, at);
            heights.see(z);
        }
        if wanted {
            parameters(before, &tags, sink)?;
        }
        done += size;
    }
    all_in_blocks(cursor, done, count, "nodes")?;
    Ok(count)
}

/// Reads the parameters at the end of the rows of nodes of these tags.
#[cold]
fn parameters(mut cursor: Cursor<'_>, tags: &[u64], sink: &mut dyn Sink) -> Result<(), ReadError> {
    let mut numbers = TextNumbers::default();
    for (done, _) in (0..).zip(tags) {
        row(&mut cursor, done, tags.len() as u64, "nodes")?;
        cursor.tokens(3);
        numbers.read(&mut cursor)?;
        numbers.read(&mut cursor)?;
    }
    sink.parameter_numbers(numbers.finish(Precision::Double, Some(tags.to_vec())));
    Ok(())
}

/// Reads `$Elements` after its first line, in version 4.1 or 4.0, which differ in what comes first of a block. Returns
/// their number.
pub(super) fn elements(
    cursor: &mut Cursor<'_>,
    version: Version,
    model: &Model,
    sink: &mut dyn Sink,
) -> Result<u64, ReadError> {
    row(cursor, 0, 1, "counts")?;
    let blocks = cursor.integer("the number of element blocks")?;
    let count = cursor.integer("the number of elements")?;
    sink.expect_elements(cursor.capacity(count, "1 1 2 3\n".len()));
    let mut done = 0;
    for block in 0..blocks {
        row(cursor, block, blocks, "element blocks")?;
        // The dimension of the entity, which is not needed, stands before its tag in 4.1 and after it in 4.0.
        if version == Version::V4 {
            cursor.token();
        }
        let entity = cursor.signed("the entity of an element block")?;
        if version == Version::V40 {
            cursor.token();
        }
        let kind = cursor.integer("the type of an element block")?;
        let kind = kind_of(cursor, kind)?;
        sink.within(&model.groups_of(kind, entity));
        let size = cursor.integer("the number of elements of a block")?;
        block_fits(cursor, size, count - done, "elements")?;
        let read = |cursor: &mut Cursor<'_>| {
            let tag = cursor.integer("an element tag")?;
            Ok(Element { tag, kind, region: [entity, 0], nodes: node_tags(cursor, kind, tag)? })
        };
        let plain = ahead(cursor, size, sink, read, |cursor, sink, element| {
            sink.element(cursor, &element).is_ok()
        });
        for at in plain..size {
            row(cursor, done + at, count, "elements")?;
            let element = read(cursor)?;
            sink.element(cursor, &element)?;
        }
        done += size;
    }
    all_in_blocks(cursor, done, count, "elements")?;
    Ok(count)
}

#[inline]
fn node_tag(cursor: &mut Cursor<'_>) -> Result<u64, ReadError> {
    cursor.integer("a node tag")
}

/// x and y with the place of x, and z with its own.
type Point = ((usize, [f64; 2]), (usize, f64));

/// Reads a node's coordinates.
#[inline]
fn point(cursor: &mut Cursor<'_>, owner: impl Display + Copy) -> Result<Point, ReadError> {
    Ok((cursor.point(owner)?, cursor.height(owner)?))
}
