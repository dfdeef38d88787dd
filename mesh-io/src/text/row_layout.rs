//! Chooses whether a list is read by rows or by words.

use crate::text::cursor::Cursor;
use crate::text::syntax::Syntax;

/// Returns the syntax for the text from the cursor to byte `end`. Text with exactly `count` rows is read by rows, so
/// that errors name the row that lacks a number. Any other text is read by words.
pub(crate) fn of_rows_or_words(cursor: &Cursor<'_>, end: usize, count: u64) -> Syntax {
    let bytes = &cursor.source.bytes[..end];
    let lines = memchr::memchr_iter(b'\n', bytes[cursor.at()..].trim_ascii_end()).count() as u64;
    // Blank lines and comments add to the line count, but not to the row count.
    match lines == count || (lines > count && rows(cursor, end) == count) {
        true => Syntax::PLAIN,
        false => Syntax::WORDS,
    }
}

/// Counts the rows behind the current row, up to byte `end`.
fn rows(cursor: &Cursor<'_>, end: usize) -> u64 {
    let mut rows = Cursor::within(cursor.source, cursor.at()..end);
    // Skips the rest of the current row.
    rows.rest();
    std::iter::from_fn(|| rows.next_row().then_some(())).count() as u64
}
