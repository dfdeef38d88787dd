//! The nodes of version 4.0: blocks, one per entity of the model, with the tag of each node before its coordinates.

use super::{all_in_blocks, block_fits, row};
use crate::error::ReadError;
use crate::file::heights::Heights;
use crate::file::sink::{Sink, each_row};
use crate::file::text::Cursor;

/// Reads `$Nodes` after its first line. Returns their number.
pub(super) fn nodes(
    cursor: &mut Cursor<'_>,
    heights: &mut Heights,
    sink: &mut dyn Sink,
) -> Result<u64, ReadError> {
    row(cursor, 0, 1, "counts")?;
    let blocks = cursor.integer("the number of node blocks")?;
    let count = cursor.vertex_count()?;
    sink.expect_nodes(cursor.capacity(count, "1 0 0 0\n".len()));
    let mut done = 0;
    for block in 0..blocks {
        row(cursor, block, blocks, "node blocks")?;
        cursor.token(); // The entity's own tag, which may be negative.
        let dimension = cursor.integer("the dimension of a node block")?;
        let parametric = cursor.integer("whether the nodes are parametric")? != 0;
        if parametric && dimension >= 2 {
            super::note_parameters(sink);
        }
        let size = cursor.integer("the number of nodes of a block")?;
        block_fits(cursor, size, count - done, "nodes")?;
        let read = |cursor: &mut Cursor<'_>| {
            let tag = cursor.integer("a node tag")?;
            let owner = format_args!("node {tag}");
            let point = cursor.point(owner)?;
            Ok((tag, point, cursor.height(owner)?))
        };
        each_row(cursor, size, "nodes", sink, read, |cursor, sink, _, (tag, (x_at, at), z)| {
            sink.node(cursor, tag, dimension, x_at, at);
            heights.see(z);
            Ok(())
        })?;
        done += size;
    }
    all_in_blocks(cursor, done, count, "nodes")?;
    Ok(count)
}
