//! B-trees of versions 1 and 2, which lead to the links of groups, to attributes and to chunks.

use super::bytes::{ByteReader, Hdf5Error};
use super::checksum::Checksum;
use super::file_bytes::FileBytes;

/// Limit on the levels of a tree. The leaves of a deeper tree would exceed the bytes of any disk.
const MAX_DEPTH: u8 = 32;

/// A B-tree of version 1.
pub(super) struct Tree<'r, 'a> {
    raw: &'r FileBytes<'a>,
    kind: u8,
    /// Size in bytes of the key before each child address.
    key: usize,
}

impl<'r, 'a> Tree<'r, 'a> {
    /// Makes a reader of the tree of a group, whose leaves lead to tables of links.
    pub(super) fn of_groups(raw: &'r FileBytes<'a>) -> Self {
        Tree { raw, kind: 0, key: raw.widths.length }
    }

    /// Makes a reader of the tree of chunks of a dataset with `rank` dimensions.
    pub(super) fn of_chunks(raw: &'r FileBytes<'a>, rank: usize) -> Self {
        Tree { raw, kind: 1, key: 4 + 4 + 8 * (rank + 1) }
    }

    /// Calls `take` for each child of a leaf: with a reader at the key before the child, the child's address, and the
    /// offset of the address field.
    pub(super) fn each(
        &self,
        root: usize,
        take: &mut dyn FnMut(ByteReader<'a>, usize, usize) -> Result<(), Hdf5Error>,
    ) -> Result<(), Hdf5Error> {
        // Nodes still to be read, the next node last, each with its expected level.
        let mut nodes = vec![(root, None)];
        while let Some((node, expected)) = nodes.pop() {
            let mut bytes = self.raw.at(node, "a tree of the HDF5 file");
            bytes.expect(b"TREE")?;
            let (kind, level, count) = (bytes.byte()?, bytes.byte()?, bytes.count(2)?);
            let is_level = expected.is_none_or(|expected| expected == level) && level < MAX_DEPTH;
            if kind != self.kind || !is_level {
                return Err(bytes.damaged());
            }
            bytes.skip(2 * self.raw.widths.address)?;
            let mut children = Vec::new();
            for _ in 0..count {
                let key = bytes.clone();
                bytes.skip(self.key)?;
                let at = bytes.at();
                let child = bytes.address()?.ok_or_else(|| bytes.damaged())?;
                match level {
                    0 => take(key, child, at)?,
                    _ => children.push((child, Some(level - 1))),
                }
            }
            nodes.extend(children.into_iter().rev());
            self.raw.claim(node..bytes.at(), &bytes)?;
        }
        Ok(())
    }
}

/// Returns the records of the B-tree of version 2 at offset `at`, in no particular order.
pub(super) fn records<'a>(raw: &FileBytes<'a>, at: usize) -> Result<Vec<&'a [u8]>, Hdf5Error> {
    let mut bytes = raw.at(at, "a tree of the HDF5 file");
    bytes.expect(b"BTHD\0")?;
    bytes.byte()?;
    let (node, record, depth) = (bytes.count(4)?, bytes.count(2)?, bytes.count(2)?);
    bytes.skip(2)?;
    let root = bytes.address()?;
    let first = bytes.count(2)?;
    bytes.length()?;
    Checksum::take(at, &mut bytes)?;
    raw.claim(at..bytes.at(), &bytes)?;
    if record == 0 || depth > usize::from(MAX_DEPTH) || node > raw.bytes.len() {
        return Err(bytes.damaged());
    }
    let Some(root) = root else { return Ok(Vec::new()) };
    let widths = widths(raw, [node, record, depth]);
    let mut records = Vec::new();
    let mut nodes = vec![(root, first, depth)];
    while let Some((at, count, level)) = nodes.pop() {
        let mut bytes = raw.at(at, "a tree of the HDF5 file");
        bytes.expect(if level == 0 { b"BTLF\0" } else { b"BTIN\0" })?;
        bytes.byte()?;
        for _ in 0..count {
            records.push(bytes.take(record)?);
        }
        if level > 0 {
            for _ in 0..=count {
                let child = bytes.address()?.ok_or_else(|| bytes.damaged())?;
                let own = bytes.count(widths[0])?;
                bytes.skip(if level > 1 { widths[level - 1] } else { 0 })?;
                nodes.push((child, own, level - 1));
            }
        }
        Checksum::take(at, &mut bytes)?;
        raw.claim(at..bytes.at(), &bytes)?;
    }
    Ok(records)
}

/// Returns the widths in bytes of the record counts in a node pointer. Element 0 is for the child's own records,
/// element n for all records in and below a child of level n.
fn widths(raw: &FileBytes<'_>, [node, record, depth]: [usize; 3]) -> Vec<usize> {
    let width = |most: usize| most.max(1).ilog2() as usize / 8 + 1;
    let room = node.saturating_sub(10);
    // The largest number of records in a leaf, and in and below a node of each level.
    let leaf = room / record;
    let (mut widths, mut all) = (vec![width(leaf)], leaf);
    for level in 1..=depth {
        let below = if level > 1 { widths[level - 1] } else { 0 };
        let pointer = raw.widths.address + widths[0] + below;
        let own = room.saturating_sub(pointer) / (record + pointer);
        all = (own + 1).saturating_mul(all).saturating_add(own);
        widths.push(width(all));
    }
    widths
}
