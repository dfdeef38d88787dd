//! Lists of a text file, row by row or on all threads.

use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::text::parallel_rows::take_rows;
use crate::visit::items::CellKind;
use crate::visit::visitor::MeshVisitor;

/// Reads a list and hands its items, one in each row, to the visitor with their positions. Plain rows are read on all
/// threads if the visitor allows it. The rest is read row by row, or as the cursor's syntax lays out items.
pub(crate) fn each_row<'a, T: Send>(
    cursor: &mut Cursor<'a>,
    count: u64,
    what: &str,
    visitor: &mut dyn MeshVisitor,
    read: impl Fn(&mut Cursor<'a>) -> Result<T, ReadError> + Sync,
    take: impl FnMut(&Cursor<'a>, &mut dyn MeshVisitor, u64, T) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let next = |cursor: &mut Cursor<'a>, done: u64| cursor.row(done, count, what);
    each_item(cursor, count, visitor, next, |cursor, _| read(cursor), take)
}

/// Reads a list as [`each_row`] does. `next` moves to the next item, given how many were read. `read` may get the
/// item's position, for messages.
pub(crate) fn each_item<'a, T: Send>(
    cursor: &mut Cursor<'a>,
    count: u64,
    visitor: &mut dyn MeshVisitor,
    next: impl Fn(&mut Cursor<'a>, u64) -> Result<(), ReadError>,
    read: impl Fn(&mut Cursor<'a>, Option<u64>) -> Result<T, ReadError> + Sync,
    mut take: impl FnMut(&Cursor<'a>, &mut dyn MeshVisitor, u64, T) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let mut done = 0;
    if visitor.allows_parallel() {
        // The visitor uses this cursor for errors only. They are dropped here, as reading row by row meets them again.
        let nowhere = &Cursor::new(cursor.source);
        take_rows(
            cursor,
            count,
            |cursor| read(cursor, None),
            |item| {
                let taken = take(nowhere, visitor, done, item).is_ok();
                done += u64::from(taken);
                taken
            },
        );
        if done > 0 {
            // The cursor stands on the last row, before its words. A reader that continues by words must find none of
            // them.
            cursor.rest();
        }
    }
    let mut missing = None;
    let mut is_plain = done > 0;
    while done < count {
        let read = |cursor: &mut Cursor<'a>| read(cursor, Some(done));
        let item = next(cursor, done).and_then(|()| cursor.item(read, &mut missing));
        match item.and_then(|item| take(cursor, visitor, done, item)) {
            Ok(()) => {}
            // If one row among many lacks a number, the rows after it are read wrongly.
            Err(error) if is_plain => return Err(missing.unwrap_or(error)),
            Err(error) => return Err(error),
        }
        is_plain |= missing.is_none();
        done += 1;
    }
    Ok(())
}

/// Reads all rows that follow, of any kind, and hands them to `take`. Long files are read on all threads if the visitor
/// allows it.
pub(crate) fn all_rows<'a, T: Send>(
    cursor: &mut Cursor<'a>,
    visitor: &mut dyn MeshVisitor,
    read: impl Fn(&mut Cursor<'a>) -> Result<T, ReadError> + Sync,
    mut take: impl FnMut(&Cursor<'a>, &mut dyn MeshVisitor, T) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    if visitor.allows_parallel() && cursor.is_long() {
        let nowhere = &Cursor::new(cursor.source);
        take_rows(cursor, u64::MAX, &read, |item| take(nowhere, visitor, item).is_ok());
    }
    while cursor.next_row() {
        let item = read(cursor)?;
        take(cursor, visitor, item)?;
    }
    Ok(())
}

/// Reads the numbers of an element's nodes.
#[inline]
pub(crate) fn nodes(cursor: &mut Cursor<'_>, kind: CellKind) -> Result<[u64; 4], ReadError> {
    let mut nodes = [0; 4];
    for node in &mut nodes[..kind.nodes()] {
        *node = cursor.integer(format_args!("a vertex of a {}", kind.name()))?;
    }
    Ok(nodes)
}

/// Returns the error that a file holds elements of a volume.
#[cold]
pub(crate) fn volume(cursor: &Cursor<'_>, what: &str) -> ReadError {
    let problem = format!("{what} make this a volume mesh");
    cursor.error(problem, "Only meshes of the plane are read: save a mesh of the plane")
}
