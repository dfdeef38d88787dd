//! Reads lists of a text file, on all threads or row by row.

use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::text::parallel_rows::take_rows;
use crate::visit::items::CellKind;
use crate::visit::visitor::MeshVisitor;

/// Reads a list of `count` items, one in each row. `read` parses an item; `take` gets the visitor, the item's 0-based
/// position and the item, in file order. If the visitor allows, plain rows are read on all threads. Remaining items are
/// read row by row, or as the cursor's syntax lays out items. `what` names the items in errors.
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

/// Reads a list as [`each_row`] does. `next` moves the cursor to the next item, given the number of items before.
/// `read` gets the item's position for messages, or `None` on other threads.
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
        // The visitor uses the cursor for errors alone. Errors are dropped here, as reading row by row meets them
        // again.
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
            // The cursor is on the last row taken, before its words. A reader that continues by words must not read the
            // row again.
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
            // If one row among many lacks a number, every later item starts at a wrong word. The first such row has the
            // true error.
            Err(error) if is_plain => return Err(missing.unwrap_or(error)),
            Err(error) => return Err(error),
        }
        is_plain |= missing.is_none();
        done += 1;
    }
    Ok(())
}

/// Checks that a list ends after its announced items: that `read` reads no item of it from the next row. Text of other kinds may
/// follow. The cursor stays where it is.
///
/// # Errors
/// At the further item. A count that is too small would drop elements of the mesh without a word.
pub(crate) fn end_of_list<'a, T>(
    cursor: &Cursor<'a>,
    count: u64,
    what: &str,
    read: impl FnOnce(&mut Cursor<'a>) -> Result<T, ReadError>,
) -> Result<(), ReadError> {
    let mut next = cursor.clone();
    if next.row(0, 1, what).is_err() {
        return Ok(());
    }
    let at = next.clone();
    match read(&mut next) {
        Ok(_) => {
            let problem = format!("further {what} follow the {count} that the file announces");
            Err(at.error(problem, "Correct the count, or write the mesh again"))
        }
        Err(_) => Ok(()),
    }
}

/// Reads all following rows, of any kind, and passes each to `take`. If the visitor allows, long files are read on all
/// threads.
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

/// Reads the node ids of an element; unused entries are 0.
#[inline]
pub(crate) fn nodes(cursor: &mut Cursor<'_>, kind: CellKind) -> Result<[u64; 4], ReadError> {
    let mut nodes = [0; 4];
    for node in &mut nodes[..kind.nodes()] {
        *node = cursor.integer(format_args!("a vertex of a {}", kind.name()))?;
    }
    Ok(nodes)
}

/// Returns the error for a file with volume elements, which `what` names.
#[cold]
pub(crate) fn volume(cursor: &Cursor<'_>, what: &str) -> ReadError {
    let problem = format!("{what} make this a volume mesh");
    cursor.error(problem, "Only meshes of the plane are read: save a mesh of the plane")
}
