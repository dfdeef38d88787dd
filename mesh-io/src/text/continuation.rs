//! Rows that go on in lines which start with a blank, a comma, `+` or `*`, as cards of Nastran do.

use crate::text::token::line_end;

/// Whether a line end or a comment, which starts with `#` or with the byte `comment`, is at `at`.
pub(super) fn is_left_out(bytes: &[u8], at: usize, comment: u8) -> bool {
    let first = bytes.get(at);
    first.is_none_or(|&byte| matches!(byte, b'\n' | b'\r' | b'#') || byte == comment)
}

/// Returns the end of the lines that belong to the line which ends at `end`. Comments start with `#` or with the byte
/// `comment`.
pub(super) fn continued_end(bytes: &[u8], mut end: usize, comment: u8) -> usize {
    let mut next = end;
    while next < bytes.len() {
        let goes_on = matches!(bytes[next], b' ' | b'\t' | b'+' | b'*' | b',');
        if !goes_on && !is_left_out(bytes, next, comment) {
            break;
        }
        let start = next;
        next = line_end(bytes, start);
        if goes_on && !bytes[start..next].trim_ascii().is_empty() {
            end = next;
        }
    }
    end
}
