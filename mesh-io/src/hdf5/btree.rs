//! Trees of both versions that tell where parts of a file stand.

use super::bytes::{ByteReader, Hdf5Error};
use super::checksum::Checksum;
use super::file_bytes::FileBytes;

/// Limit on the levels of a tree. A deeper tree would have more leaves than there are bytes on any disk.
const MAX_DEPTH: u8 = 32;

/// A tree of version 1.
pub(super) struct Tree<'r, 'a> {
    raw: &'r FileBytes<'a>,
    kind: u8,
    /// How many bytes there are between the addresses of two nodes.
    key: usize,
}

impl<'r, 'a> Tree<'r, 'a> {
    /// Of tables of links.
    pub(super) fn of_groups(raw: &'r FileBytes<'a>) -> Self {
        Tree { raw, kind: 0, key: raw.widths.length }
    }

    /// Of the chunks of a dataset of so many dimensions.
    pub(super) fn of_chunks(raw: &'r FileBytes<'a>, rank: usize) -> Self {
        Tree { raw, kind: 1, key: 4 + 4 + 8 * (rank + 1) }
    }

    /// Hands on what the leaves lead to: the key before it, its address, and where the address stands.
    pub(super) fn each(
        &self,
        root: usize,
        take: &mut dyn FnMut(ByteReader<'a>, usize, usize) -> Result<(), Hdf5Error>,
    ) -> Result<(), Hdf5Error> {
        // The nodes to be read, the next one last, and the level of each.
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

/// The records of a tree of version 2.
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

/// How many bytes the number of records of a leaf has, and that of all below a node, by level.
fn widths(raw: &FileBytes<'_>, [node, record, depth]: [usize; 3]) -> Vec<usize> {
    let width = |most: usize| most.max(1).ilog2() as usize / 8 + 1;
    let room = node.saturating_sub(10);
    // The most records of a leaf, and of all below a node of the level.
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
