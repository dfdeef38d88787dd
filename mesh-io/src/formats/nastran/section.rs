//! Finds the lines of a file that are bulk data.

use crate::disk::source::Source;
use crate::text::cursor::Cursor;
use crate::text::syntax::Syntax;
use crate::text::token::line_end;

/// Makes a cursor before the first row of the bulk data, which does not read beyond the bulk data. Bulk data start
/// after `BEGIN BULK`, or at the start of a file without other sections, and end before `ENDDATA`.
pub(super) fn rows(source: &Source) -> Cursor<'_> {
    let bytes = &source.bytes;
    let (mut begin, mut end, mut at) = (None, bytes.len(), source.begin());
    while at < bytes.len() {
        let next = line_end(bytes, at);
        match bytes[at] {
            b'B' | b'b' | b' ' if begin.is_none() && is_begin(&bytes[at..next]) => begin = Some(at),
            b'E' | b'e' if starts_with(&bytes[at..next], b"ENDDATA") => {
                end = at;
                break;
            }
            _ => {}
        }
        at = next;
    }
    let mut rows = match begin {
        Some(at) => Cursor::on_line_of(source, at),
        None => Cursor::new(source),
    };
    rows.bytes = &bytes[..end];
    rows.with_syntax(Syntax::CARDS)
}

/// Returns whether a line is `BEGIN BULK`, which precedes the bulk data.
pub(super) fn is_begin(line: &[u8]) -> bool {
    let line = line.trim_ascii_start();
    starts_with(line, b"BEGIN") && starts_with(line[5..].trim_ascii_start(), b"BULK")
}

fn starts_with(line: &[u8], word: &[u8]) -> bool {
    line.get(..word.len()).is_some_and(|head| head.eq_ignore_ascii_case(word))
}
