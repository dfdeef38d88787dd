//! Rows of several lines: a line that starts with a blank, a comma, `+` or `*` continues a row, as in Nastran's cards.

use crate::text::token::line_end;

/// Returns whether a line end, a comment or the end of `bytes` is at `at`. Comments start with `#` or the byte
/// `comment`.
pub(super) fn is_left_out(bytes: &[u8], at: usize, comment: u8) -> bool {
    let first = bytes.get(at);
    first.is_none_or(|&byte| matches!(byte, b'\n' | b'\r' | b'#') || byte == comment)
}

/// Returns the exclusive end of a row whose first line ends at `end`. Blank lines and comments behind the last
/// continuation line are excluded. Comments start with `#` or the byte `comment`.
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
