//! Nodes of version 4.0 as text, in a block for each entity of the model. The tag of each node precedes its
//! coordinates.

use super::lists::{all_in_blocks, block_fits, by_rows, counts, each, head, note_parameters};
use super::words::Progress;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

/// Reads `$Nodes` after its first line. Returns the number of nodes.
pub(super) fn nodes(
    cursor: &mut Cursor<'_>,
    z_values: &mut ZValues,
    visitor: &mut dyn MeshVisitor,
) -> Result<u64, ReadError> {
    let read = |cursor: &mut Cursor<'_>| {
        Ok((cursor.integer("the number of node blocks")?, cursor.vertex_count()?))
    };
    let (blocks, count) = counts(cursor, read, |(blocks, count)| blocks.saturating_add(count))?;
    visitor.expect_nodes(cursor.capacity(count, "1 0 0 0\n".len()));
    let mut done = 0;
    for block in 0..blocks {
        let read = |cursor: &mut Cursor<'_>| {
            cursor.token(); // The entity's own tag, which may be negative.
            let dimension = cursor.integer("the dimension of a node block")?;
            let parametric = cursor.integer("whether the nodes are parametric")? != 0;
            Ok((dimension, parametric, cursor.integer("the number of nodes of a block")?))
        };
        let (dimension, parametric, size) =
            head(cursor, Progress::new(block, blocks, "node blocks"), read)?;
        if parametric && dimension >= 2 {
            note_parameters(visitor);
        }
        block_fits(cursor, size, count - done, "nodes")?;
        let read = |cursor: &mut Cursor<'_>, _| {
            let tag = cursor.integer("a node tag")?;
            let point = cursor.point(format_args!("node {tag}"))?;
            Ok((tag, point, cursor.z(format_args!("node {tag}"))?))
        };
        // Parameters end the row of a node.
        by_rows(cursor, parametric, |cursor| {
            let progress = Progress::new(done, count, "nodes");
            each(
                cursor,
                size,
                progress,
                visitor,
                read,
                |cursor, visitor, _, (tag, (x_at, at), z)| {
                    visitor.node(cursor, tag, dimension, x_at, at);
                    z_values.push(z);
                    Ok(())
                },
            )
        })?;
        done += size;
    }
    all_in_blocks(cursor, done, count, "nodes")?;
    Ok(count)
}
