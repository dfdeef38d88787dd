//! Sections of version 4.1 as text, and the elements of 4.0. Nodes and elements form blocks, a block for each entity of
//! the model.

use super::encoding::Version;
use super::kind::{kind_of, node_tags};
use super::lists::{all_in_blocks, block_fits, by_rows, counts, each, has_parameters, head, row};
use super::model::Model;
use super::words::Progress;
use crate::error::ReadError;
use crate::precision::Precision;
use crate::text::cursor::Cursor;
use crate::text::syntax::Syntax;
use crate::visit::items::Element;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::{TextNumbers, ZValues};
use std::fmt::Display;

/// Reads `$Nodes` after its first line. Returns the number of nodes.
pub(super) fn nodes(
    cursor: &mut Cursor<'_>,
    z_values: &mut ZValues,
    visitor: &mut dyn MeshVisitor,
) -> Result<u64, ReadError> {
    let read = |cursor: &mut Cursor<'_>| {
        let blocks = cursor.integer("the number of node blocks")?;
        let count = cursor.vertex_count()?;
        skip_min_and_max(cursor);
        Ok((blocks, count))
    };
    let rows = |(blocks, count): (u64, u64)| blocks.saturating_add(2 * count);
    let (blocks, count) = counts(cursor, read, rows)?;
    visitor.expect_nodes(cursor.capacity(count, "1\n0 0 0\n".len()));
    let mut done = 0;
    let mut tags = Vec::new();
    for block in 0..blocks {
        let read = |cursor: &mut Cursor<'_>| {
            let dimension = cursor.integer("the dimension of a node block")?;
            let entity = cursor.signed("the entity of a node block").unwrap_or(0);
            let parametric = cursor.integer("whether the nodes are parametric")? != 0;
            let size = cursor.integer("the number of nodes of a block")?;
            Ok((dimension, entity, parametric, size))
        };
        let head = head(cursor, Progress::new(block, blocks, "node blocks"), read)?;
        let (dimension, entity, parametric, size) = head;
        let wanted = parametric && dimension == 2 && has_parameters(visitor, entity);
        block_fits(cursor, size, count - done, "nodes")?;
        tags.clear();
        tags.reserve(cursor.capacity(size, "1\n0 0 0\n".len()));
        let read = |cursor: &mut Cursor<'_>, _| cursor.integer("a node tag");
        each(
            cursor,
            size,
            Progress::new(done, count, "node tags"),
            visitor,
            read,
            |_, _, _, tag| {
                tags.push(tag);
                Ok(())
            },
        )?;
        let before = cursor.clone();
        let tag = |at: Option<u64>| {
            at.and_then(|at| tags.get(usize::try_from(at).ok()?)).copied().unwrap_or(0)
        };
        let read = |cursor: &mut Cursor<'_>, at| point(cursor, format_args!("node {}", tag(at)));
        by_rows(cursor, parametric, |cursor| {
            let progress = Progress::new(done, count, "nodes");
            each(
                cursor,
                size,
                progress,
                visitor,
                read,
                |cursor, visitor, at, ((x_at, point), z)| {
                    visitor.node(cursor, tag(Some(at)), dimension, x_at, point);
                    z_values.push(z);
                    Ok(())
                },
            )
        })?;
        if wanted {
            parameters(before, &tags, visitor)?;
        }
        done += size;
    }
    all_in_blocks(cursor, done, count, "nodes")?;
    Ok(count)
}

/// Skips the smallest and largest tag of a section, which readers do not need.
fn skip_min_and_max(cursor: &mut Cursor<'_>) {
    cursor.token();
    cursor.token();
}

/// Reads the two parameters at the end of each node's row, and visits them. `cursor` precedes the coordinate rows of a
/// block.
#[cold]
fn parameters(
    mut cursor: Cursor<'_>,
    tags: &[u64],
    visitor: &mut dyn MeshVisitor,
) -> Result<(), ReadError> {
    let mut numbers = TextNumbers::default();
    cursor.syntax = Syntax::PLAIN;
    for (done, _) in (0..).zip(tags) {
        row(&mut cursor, done, tags.len() as u64, "nodes")?;
        cursor.tokens(3);
        numbers.read(&mut cursor)?;
        numbers.read(&mut cursor)?;
    }
    visitor.parameter_numbers(numbers.finish(Precision::Double, Some(tags.to_vec())));
    Ok(())
}

/// Reads `$Elements` of version 4.0 or 4.1, which differ in the header of a block, after its first line. Returns the
/// number of elements.
pub(super) fn elements(
    cursor: &mut Cursor<'_>,
    version: Version,
    model: &Model,
    visitor: &mut dyn MeshVisitor,
) -> Result<u64, ReadError> {
    let read = |cursor: &mut Cursor<'_>| {
        let blocks = cursor.integer("the number of element blocks")?;
        let count = cursor.integer("the number of elements")?;
        if version == Version::V41 {
            skip_min_and_max(cursor);
        }
        Ok((blocks, count))
    };
    let rows = |(blocks, count): (u64, u64)| blocks.saturating_add(count);
    let (blocks, count) = counts(cursor, read, rows)?;
    visitor.expect_elements(cursor.capacity(count, "1 1 2 3\n".len()));
    let mut done = 0;
    for block in 0..blocks {
        let read = |cursor: &mut Cursor<'_>| {
            // The dimension of the entity is skipped; its place is before the entity's tag in 4.1, and behind the tag
            // in 4.0.
            if version == Version::V41 {
                cursor.token();
            }
            let entity = cursor.signed("the entity of an element block")?;
            if version == Version::V40 {
                cursor.token();
            }
            let kind = cursor.integer("the type of an element block")?;
            let kind = kind_of(cursor, kind)?;
            Ok((entity, kind, cursor.integer("the number of elements of a block")?))
        };
        let (entity, kind, size) =
            head(cursor, Progress::new(block, blocks, "element blocks"), read)?;
        visitor.group_scopes(&model.groups_of(kind, entity));
        block_fits(cursor, size, count - done, "elements")?;
        let read = |cursor: &mut Cursor<'_>, _| {
            let tag = cursor.integer("an element tag")?;
            Ok(Element { id: tag, kind, region: [entity, 0], nodes: node_tags(cursor, kind, tag)? })
        };
        let progress = Progress::new(done, count, "elements");
        each(cursor, size, progress, visitor, read, |cursor, visitor, _, element| {
            visitor.element(cursor, &element)
        })?;
        done += size;
    }
    all_in_blocks(cursor, done, count, "elements")?;
    Ok(count)
}

/// Offset of x with x and y, and offset of z with z.
type Point = ((usize, [f64; 2]), (usize, f64));

/// Reads the coordinates of a node, called `owner` in messages.
#[inline]
fn point(cursor: &mut Cursor<'_>, owner: impl Display + Copy) -> Result<Point, ReadError> {
    Ok((cursor.point(owner)?, cursor.z(owner)?))
}
