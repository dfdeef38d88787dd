//! The lists and blocks of a section: their counts, their rows, and how these are laid out.

use super::words::Progress;
use crate::content::remark::Remark;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::text::row_layout::of_rows_or_words;
use crate::text::syntax::Syntax;
use crate::visit::rows::each_item;
use crate::visit::visitor::MeshVisitor;

/// A remark for the user on parameters that cannot be updated.
const PARAMETRIC: &str =
    "nodes have parameters on surfaces of the model, which stay as they are where nodes move";

/// Chooses how the rest of a section is read: by rows if it has this many rows, else by words as gmsh does.
fn lay_out(cursor: &mut Cursor<'_>, rows: u64) {
    let (bytes, at) = (&cursor.source.bytes, cursor.at());
    let end = memchr::memmem::find(&bytes[at..], b"$End").map_or(bytes.len(), |end| at + end);
    cursor.syntax = of_rows_or_words(cursor, end, rows);
}

/// Reads a list by rows if `is_so`: each item then has a row of its own, with parameters at its end.
pub(super) fn by_rows<'a, T>(
    cursor: &mut Cursor<'a>,
    is_so: bool,
    read: impl FnOnce(&mut Cursor<'a>) -> Result<T, ReadError>,
) -> Result<T, ReadError> {
    let syntax = cursor.syntax;
    if is_so {
        cursor.syntax = Syntax::PLAIN;
    }
    let list = read(cursor)?;
    if is_so {
        cursor.rest();
        cursor.syntax = syntax;
    }
    Ok(list)
}

/// Tells the visitor that nodes have parameters, which stay as they are.
pub(super) fn note_parameters(visitor: &mut dyn MeshVisitor) {
    visitor.remark(Remark::Text(PARAMETRIC.into()));
    visitor.unsupported("parameters of nodes on surfaces");
}

/// Announces that nodes have parameters on a surface. Returns whether the visitor wants them.
pub(super) fn has_parameters(visitor: &mut dyn MeshVisitor, surface: i64) -> bool {
    visitor.unsupported("parameters of nodes on surfaces");
    visitor.parameters(surface)
}

/// Moves to the next of `count` items of a section, after `done` were read. Returns an error if the section ends before
/// it.
#[inline]
pub(super) fn row(
    cursor: &mut Cursor<'_>,
    done: u64,
    count: u64,
    what: &str,
) -> Result<(), ReadError> {
    cursor.row(done, count, what)?;
    if cursor.is_at(b'$') {
        let problem = format!("the section ends after {done} of {count} {what}");
        return Err(cursor.error(problem, "Correct the count, or save the mesh again"));
    }
    Ok(())
}

/// Hands on the next `count` items of a section. As in gmsh, items may stand anywhere on lines.
pub(super) fn each<'a, T: Send>(
    cursor: &mut Cursor<'a>,
    count: u64,
    progress: Progress<'_>,
    visitor: &mut dyn MeshVisitor,
    read: impl Fn(&mut Cursor<'a>, Option<u64>) -> Result<T, ReadError> + Sync,
    take: impl FnMut(&Cursor<'a>, &mut dyn MeshVisitor, u64, T) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let Progress { done: before, count: all, what } = progress;
    let next = |cursor: &mut Cursor<'a>, done: u64| row(cursor, before + done, all, what);
    each_item(cursor, count, visitor, next, read, take)
}

/// Reads the counts at the start of a section, and chooses how the rest is read. `rows` returns how many rows it should
/// have.
pub(super) fn counts<'a, T: Copy>(
    cursor: &mut Cursor<'a>,
    read: impl Fn(&mut Cursor<'a>) -> Result<T, ReadError>,
    rows: impl Fn(T) -> u64,
) -> Result<T, ReadError> {
    cursor.syntax = Syntax::WORDS;
    let counts = head(cursor, Progress::new(0, 1, "counts"), read)?;
    lay_out(cursor, rows(counts));
    Ok(counts)
}

/// Reads the header of the next list or block.
pub(super) fn head<'a, T>(
    cursor: &mut Cursor<'a>,
    Progress { done, count, what }: Progress<'_>,
    read: impl Fn(&mut Cursor<'a>) -> Result<T, ReadError>,
) -> Result<T, ReadError> {
    row(cursor, done, count, what)?;
    cursor.item(read, &mut None)
}

/// Checks that a block of `size` items is not larger than what the section's count leaves for it.
pub(super) fn block_fits(
    cursor: &Cursor<'_>,
    size: u64,
    left: u64,
    what: &str,
) -> Result<(), ReadError> {
    if size <= left {
        return Ok(());
    }
    let problem = format!("a block of {size} {what} where the section's count leaves {left}");
    Err(cursor.error(problem, "Correct the counts, or save the mesh again"))
}

pub(super) fn all_in_blocks(
    cursor: &Cursor<'_>,
    done: u64,
    count: u64,
    what: &str,
) -> Result<(), ReadError> {
    if done == count {
        return Ok(());
    }
    let problem = format!("the blocks hold {done} of the {count} {what} the section announces");
    Err(cursor.error(problem, "Correct the counts, or save the mesh again"))
}
