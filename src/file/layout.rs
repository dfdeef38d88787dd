//! Whether the items of a list stand on rows of their own, or anywhere.

use crate::file::syntax::Syntax;
use crate::file::text::Cursor;

/// How to read what follows the row of a cursor, up to a byte of the file: by rows, if it has as many as its lists are to have, so
/// that errors tell of a row that lacks a number; by words if not.
pub(crate) fn of_rows_or_words(cursor: &Cursor<'_>, end: usize, count: u64) -> Syntax {
    let bytes = &cursor.source.bytes[..end];
    let lines = memchr::memchr_iter(b'\n', bytes[cursor.at()..].trim_ascii_end()).count() as u64;
    // Some lines may be blank, or comments.
    match lines == count || (lines > count && rows(cursor, end) == count) {
        true => Syntax::PLAIN,
        false => Syntax::WORDS,
    }
}

/// How many rows follow.
fn rows(cursor: &Cursor<'_>, end: usize) -> u64 {
    let mut rows = Cursor::within(cursor.source, cursor.at()..end);
    // The rest of the row at hand.
    rows.rest();
    std::iter::from_fn(|| rows.next_row().then_some(())).count() as u64
}
