//! Tells whether the items of a list stand on rows of their own, or anywhere.

use crate::text::cursor::Cursor;
use crate::text::syntax::Syntax;

/// Chooses how to read the text from the cursor to byte `end`. If it has `count` rows, it is read by rows, so that
/// errors name a row that lacks a number. Otherwise it is read by words.
pub(crate) fn of_rows_or_words(cursor: &Cursor<'_>, end: usize, count: u64) -> Syntax {
    let bytes = &cursor.source.bytes[..end];
    let lines = memchr::memchr_iter(b'\n', bytes[cursor.at()..].trim_ascii_end()).count() as u64;
    // Some lines may be blank, or comments.
    match lines == count || (lines > count && rows(cursor, end) == count) {
        true => Syntax::PLAIN,
        false => Syntax::WORDS,
    }
}

/// Counts the rows that follow.
fn rows(cursor: &Cursor<'_>, end: usize) -> u64 {
    let mut rows = Cursor::within(cursor.source, cursor.at()..end);
    // Skips the rest of the current row.
    rows.rest();
    std::iter::from_fn(|| rows.next_row().then_some(())).count() as u64
}
