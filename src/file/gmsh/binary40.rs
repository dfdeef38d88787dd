//! The sections of version 4.0 in binary: blocks, one per entity of the model, with tags of four bytes.

use super::kind::kind_of;
use super::model::Model;
use super::words::Words;
use super::{all_in_blocks, block_fits};
use crate::error::ReadError;
use crate::file::binary::Order;
use crate::file::heights::Heights;
use crate::file::sink::{Element, Sink};
use crate::file::text::Cursor;

/// The bytes of a block's header: three `int` and an `unsigned long`.
const BLOCK_HEADER: usize = 20;
const TAG: usize = 4;

/// Reads `$Nodes` after its first line. Returns their number.
pub(super) fn nodes(
    cursor: &mut Cursor<'_>,
    order: Order,
    heights: &mut Heights,
    sink: &mut impl Sink,
) -> Result<u64, ReadError> {
    let [blocks, count] = counts(cursor, order)?;
    cursor.check_vertex_count(count)?;
    sink.expect_nodes(cursor.capacity(count, TAG + 24));
    let mut done = 0;
    for block in 0..blocks {
        let words = &mut Words::take(cursor, order, BLOCK_HEADER, (block, blocks, "node blocks"))?;
        words.int(); // The entity's own tag.
        let dimension = words.natural(cursor, "the dimension of a node block")?;
        let parametric = words.int() != 0;
        if parametric && dimension >= 2 {
            super::note_parameters(sink);
        }
        let size = words.size();
        block_fits(cursor, size, count - done, "nodes")?;
        // Those of points have none, and those of volumes none either.
        let parameters = if parametric && dimension < 3 { dimension as usize } else { 0 };
        for at in 0..size {
            let progress = (done + at, count, "nodes");
            let words = &mut Words::take(cursor, order, TAG + 8 * (3 + parameters), progress)?;
            let tag = words.natural(cursor, "a node tag")?;
            let [x, y, z] = words.point(cursor, tag)?;
            let x_at = cursor.taken() + TAG;
            sink.node(cursor, tag, dimension, x_at, [x, y]);
            heights.see((x_at + 16, z));
        }
        done += size;
    }
    all_in_blocks(cursor, done, count, "nodes")?;
    Ok(count)
}

/// Reads `$Elements` after its first line. Returns their number.
pub(super) fn elements(
    cursor: &mut Cursor<'_>,
    order: Order,
    model: &Model,
    sink: &mut impl Sink,
) -> Result<u64, ReadError> {
    let [blocks, count] = counts(cursor, order)?;
    sink.expect_elements(cursor.capacity(count, 4 * TAG));
    let mut done = 0;
    for block in 0..blocks {
        let words =
            &mut Words::take(cursor, order, BLOCK_HEADER, (block, blocks, "element blocks"))?;
        let region = [i64::from(words.int()), 0];
        words.int(); // The entity's dimension.
        let kind = words.natural(cursor, "the type of an element block")?;
        let kind = kind_of(cursor, kind)?;
        sink.within(&model.groups_of(kind, region[0]));
        let size = words.size();
        block_fits(cursor, size, count - done, "elements")?;
        let row = TAG * (1 + kind.nodes());
        for at in 0..size {
            let words = &mut Words::take(cursor, order, row, (done + at, count, "elements"))?;
            let tag = words.natural(cursor, "an element tag")?;
            let mut nodes = [0; 4];
            for node in &mut nodes[..kind.nodes()] {
                *node = words.natural(cursor, format_args!("a node of element {tag}"))?;
            }
            sink.element(cursor, &Element { tag, kind, region, nodes })?;
        }
        done += size;
    }
    all_in_blocks(cursor, done, count, "elements")?;
    Ok(count)
}

/// How many blocks a section has, and how many nodes or elements are in all of them.
fn counts(cursor: &mut Cursor<'_>, order: Order) -> Result<[u64; 2], ReadError> {
    let words = &mut Words::take(cursor, order, 16, (0, 1, "counts"))?;
    Ok([words.size(), words.size()])
}
