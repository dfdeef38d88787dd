//! Rows that go on in lines which start with a blank, a comma, `+` or `*`, as cards of Nastran do.

use crate::text::cursor::Cursor;
use crate::text::token::line_end;
use std::ops::Range;

impl Cursor<'_> {
    /// Whether a comment or a line end starts here.
    pub(crate) fn is_left_out(&self, at: usize) -> bool {
        let first = self.bytes.get(at);
        first
            .is_none_or(|&byte| matches!(byte, b'\n' | b'\r' | b'#') || byte == self.syntax.comment)
    }

    /// Returns where the lines end that belong to the one which ends here.
    pub(crate) fn continued_end(&self, mut end: usize) -> usize {
        let mut next = end;
        while next < self.bytes.len() {
            let goes_on = matches!(self.bytes[next], b' ' | b'\t' | b'+' | b'*' | b',');
            if !goes_on && !self.is_left_out(next) {
                break;
            }
            let start = next;
            next = line_end(self.bytes, start);
            if goes_on && !self.bytes[start..next].trim_ascii().is_empty() {
                end = next;
            }
        }
        end
    }

    /// Returns the range of the current row, from the start of its first line on.
    pub(crate) fn row_range(&self) -> Range<usize> {
        let start = memchr::memrchr(b'\n', &self.bytes[..self.at]).map_or(0, |before| before + 1);
        start.max(self.source.begin())..self.row_end(self.at)
    }
}
