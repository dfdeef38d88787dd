//! Nodes of version 4.0 in binary, in a block for each entity of the model. A tag of four bytes precedes the
//! coordinates of each node.

use super::binary4::{BLOCK_HEADER, counts};
use super::encoding::Version;
use super::lists::{all_in_blocks, block_fits, note_parameters};
use super::words::{Progress, Words};
use crate::binary::byte_order::ByteOrder;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

/// Size of a node tag in bytes.
const TAG: usize = 4;

/// Reads `$Nodes` after its first line. Returns the number of nodes.
pub(super) fn nodes(
    cursor: &mut Cursor<'_>,
    order: ByteOrder,
    z_values: &mut ZValues,
    visitor: &mut dyn MeshVisitor,
) -> Result<u64, ReadError> {
    let [blocks, count] = counts(cursor, Version::V40, order)?;
    cursor.check_vertex_count(count)?;
    visitor.expect_nodes(cursor.capacity(count, TAG + 24));
    let mut done = 0;
    for block in 0..blocks {
        let progress = Progress::new(block, blocks, "node blocks");
        let words = &mut Words::take(cursor, order, BLOCK_HEADER, progress)?;
        words.int(); // The entity's own tag.
        let dimension = words.natural(cursor, "the dimension of a node block")?;
        let parametric = words.int() != 0;
        if parametric && dimension >= 2 {
            note_parameters(visitor);
        }
        let size = words.size();
        block_fits(cursor, size, count - done, "nodes")?;
        // Nodes on points and in volumes have no parameters.
        let parameters = if parametric && dimension < 3 { dimension as usize } else { 0 };
        for at in 0..size {
            let progress = Progress::new(done + at, count, "nodes");
            let words = &mut Words::take(cursor, order, TAG + 8 * (3 + parameters), progress)?;
            let tag = words.natural(cursor, "a node tag")?;
            let [x, y, z] = words.point(cursor, tag)?;
            let x_at = cursor.last_taken() + TAG;
            visitor.node(cursor, tag, dimension, x_at, [x, y]);
            z_values.push((x_at + 16, z));
        }
        done += size;
    }
    all_in_blocks(cursor, done, count, "nodes")?;
    Ok(count)
}
