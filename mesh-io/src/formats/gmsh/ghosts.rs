//! Ghost elements of a partitioned mesh, from the section `$GhostElements`.

use super::encoding::{FileEncoding, Version};
use crate::text::cursor::Cursor;
use std::collections::HashSet;

/// An element of one partition that other partitions have as a ghost.
struct GhostElement {
    id: u64,
    /// The partitions that have the element as a ghost.
    partitions: Vec<u64>,
}

/// Reads a section after its first line, and returns the ids of elements that belong to other pieces of the mesh. The
/// cursor does not move. `None` if the section differs from gmsh's own layout.
///
/// A file of all partitions has the elements of every partition, and none belongs to another file. A file of one
/// partition has the ghosts of this partition alone.
pub(super) fn read(cursor: &Cursor<'_>, encoding: FileEncoding) -> Option<HashSet<u64>> {
    let cursor = &mut cursor.clone();
    let found = match encoding {
        FileEncoding { order: None, .. } => text(cursor)?,
        FileEncoding { version: Version::V41, .. } => binary(cursor, encoding)?,
        FileEncoding { .. } => return None,
    };
    let is_end = cursor.next_row() && cursor.token() == Some(b"$EndGhostElements");
    is_end.then_some(())?;
    let mut partitions = found.iter().flat_map(|ghost| &ghost.partitions);
    let first = partitions.next();
    match partitions.all(|partition| Some(partition) == first) {
        true => Some(found.into_iter().map(|ghost| ghost.id).collect()),
        false => Some(HashSet::new()),
    }
}

fn text(cursor: &mut Cursor<'_>) -> Option<Vec<GhostElement>> {
    cursor.next_row().then_some(())?;
    let count = cursor.integer("a count").ok()?;
    let mut found = Vec::with_capacity(cursor.capacity(count, "1 1 1 1\n".len()));
    for _ in 0..count {
        cursor.next_row().then_some(())?;
        let mut number = || cursor.integer("a number of a ghost").ok();
        let (id, _, others) = (number()?, number()?, number()?);
        let mut partitions = Vec::new();
        for _ in 0..others {
            partitions.push(cursor.integer("a partition").ok()?);
        }
        found.push(GhostElement { id, partitions });
    }
    Some(found)
}

fn binary(cursor: &mut Cursor<'_>, encoding: FileEncoding) -> Option<Vec<GhostElement>> {
    let order = encoding.order?;
    let size = |cursor: &mut Cursor<'_>| Some(order.whole(cursor.take(8)?));
    let int = |cursor: &mut Cursor<'_>| Some(order.whole(cursor.take(4)?));
    let mut found = Vec::new();
    for _ in 0..size(cursor)? {
        let id = size(cursor)?;
        int(cursor)?;
        let mut partitions = Vec::new();
        for _ in 0..size(cursor)? {
            partitions.push(int(cursor)?);
        }
        found.push(GhostElement { id, partitions });
    }
    Some(found)
}
