//! Elements in blocks of one shape and group, for formats that store elements block by block.

use super::content::Content;
use crate::visit::items::CellKind;
use std::collections::HashMap;

/// An element block: the cells of one kind and group.
pub(crate) struct Block {
    pub(crate) kind: CellKind,
    pub(crate) group: Option<u32>,
    pub(crate) cells: Vec<usize>,
}

/// Sorts cells into blocks by kind and group. Blocks of triangles and quadrilaterals come first, then lines, then
/// points; within a dimension, blocks are in the order of their first cell.
pub(crate) fn blocks(
    content: &Content,
    cells: impl Iterator<Item = usize>,
    group: impl Fn(usize) -> Option<u32>,
) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut places: HashMap<(u8, Option<u32>), usize> = HashMap::new();
    for cell in cells {
        let (kind, group) = (content.cells.kinds[cell], group(cell));
        let place = *places.entry((kind as u8, group)).or_insert(blocks.len());
        if place == blocks.len() {
            blocks.push(Block { kind, group, cells: Vec::new() });
        }
        blocks[place].cells.push(cell);
    }
    blocks.sort_by_key(|block| 2 - block.kind.dimension());
    blocks
}
