//! Lists and blocks of a section: counts, block headers, and the layout of items on rows of text.

use super::words::Progress;
use crate::content::remark::Remark;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::text::row_layout::of_rows_or_words;
use crate::text::syntax::Syntax;
use crate::visit::rows::each_item;
use crate::visit::visitor::MeshVisitor;

/// Remark for the user: a rewrite cannot update the parameters of moved nodes.
const PARAMETRIC: &str =
    "nodes have parameters on surfaces of the model, which stay as they are where nodes move";

/// Chooses the layout of the rest of a section: row by row if `rows` rows follow, else word by word, as gmsh parses.
fn lay_out(cursor: &mut Cursor<'_>, rows: u64) {
    let (bytes, at) = (&cursor.source.bytes, cursor.at());
    // Version 1 writes `$END`.
    let find = |word: &[u8]| memchr::memmem::find(&bytes[at..], word);
    let end = find(b"$End").or_else(|| find(b"$END")).map_or(bytes.len(), |end| at + end);
    cursor.syntax = of_rows_or_words(cursor, end, rows);
}

/// Reads a list. If `is_so`, items are read row by row, and the parameters at the end of each row are skipped.
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

/// Remarks that nodes have parameters, which a rewrite leaves unchanged.
pub(super) fn note_parameters(visitor: &mut dyn MeshVisitor) {
    visitor.remark(Remark::Text(PARAMETRIC.into()));
    visitor.unsupported("parameters of nodes on surfaces");
}

/// Announces that nodes have parameters on a surface of the model. Returns whether the visitor wants the parameters.
pub(super) fn has_parameters(visitor: &mut dyn MeshVisitor, surface: i64) -> bool {
    visitor.unsupported("parameters of nodes on surfaces");
    visitor.parameters(surface)
}

/// Moves to the next item of a section, of which `done` of `count` were read.
///
/// # Errors
/// If the section or the file ends first.
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

/// Visits the next `count` items of a section. As in gmsh, items may be anywhere on lines.
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

/// Reads the counts at the start of a section, and chooses the layout of the rest. `rows` returns the number of rows
/// for these counts if each item has a row.
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

/// Reads the header of the next list or block of a section.
pub(super) fn head<'a, T>(
    cursor: &mut Cursor<'a>,
    Progress { done, count, what }: Progress<'_>,
    read: impl Fn(&mut Cursor<'a>) -> Result<T, ReadError>,
) -> Result<T, ReadError> {
    row(cursor, done, count, what)?;
    cursor.item(read, &mut None)
}

/// Checks that a block of `size` items does not exceed the `left` items that the section's count leaves.
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

/// Checks that the blocks of a section hold as many items as the section's count announces.
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

/// Reports that elements or entities have partitions, which a conversion loses.
pub(super) fn note_partitions(visitor: &mut dyn MeshVisitor) {
    visitor.unsupported("partitions of the mesh");
}
