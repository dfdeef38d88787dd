//! Cursor over the rows and tokens of a text file.

use crate::disk::source::Source;
use crate::error::{Location, ReadError};
use crate::text::continuation::{continued_end, is_left_out};
use crate::text::syntax::{Commas, Items, Syntax};
use crate::text::token::line_end;
use std::ops::Range;

/// Remedy in messages about a single wrong line.
pub(crate) const CORRECT: &str = "Correct the line, or write the mesh again";
/// Remedy in messages about a file that ends too early.
pub(crate) const CUT_OFF: &str = "The file is cut off: copy it again, or write the mesh again";

/// Cursor over the rows of a file, which are the lines with content besides blanks and comments. In a binary file, the
/// cursor also takes bytes between lines.
#[derive(Clone)]
pub(crate) struct Cursor<'a> {
    pub(crate) source: &'a Source,
    /// The source's bytes, up to the end of the cursor's range.
    pub(crate) bytes: &'a [u8],
    pub(crate) at: usize,
    /// 1-based number of the current line. 0 before the first line and directly behind taken bytes, where the next line
    /// starts at `at`.
    line: usize,
    /// Offset of the bytes taken last; `None` in a text file.
    last_taken: Option<usize>,
    pub(crate) syntax: Syntax,
    /// Whether line ends count as blanks for the current item.
    crosses_line_ends: bool,
}

impl<'a> Cursor<'a> {
    /// Makes a cursor before the first row.
    pub(crate) fn new(source: &'a Source) -> Self {
        let at = source.begin();
        Cursor {
            source,
            bytes: &source.bytes,
            at,
            line: 0,
            last_taken: None,
            syntax: Syntax::PLAIN,
            crosses_line_ends: false,
        }
    }

    /// Makes a cursor on the line of the byte at offset `at`, for messages.
    pub(crate) fn on_line_of(source: &'a Source, at: usize) -> Self {
        let mut cursor = Cursor::new(source);
        (cursor.at, cursor.line) = (at, source.line_of(at));
        cursor
    }

    /// Makes a cursor before the byte at offset `at` of a binary file, for messages.
    pub(crate) fn at_byte_offset(source: &'a Source, at: usize) -> Self {
        let mut cursor = Cursor::new(source);
        (cursor.at, cursor.last_taken) = (at, Some(at));
        cursor
    }

    /// Makes a cursor at the start of a byte range, inside the line with the start. The cursor does not read beyond the
    /// range.
    pub(crate) fn within(source: &'a Source, range: Range<usize>) -> Self {
        let mut cursor = Cursor::on_line_of(source, range.start);
        cursor.bytes = &source.bytes[..range.end];
        cursor
    }

    /// Returns the cursor with another syntax.
    pub(crate) fn with_syntax(self, syntax: Syntax) -> Self {
        Cursor { syntax, ..self }
    }

    /// Splits the following lines into at most `count` parts of about `size` bytes. Parts end at row ends and number
    /// their lines separately.
    pub(crate) fn parts(&self, size: usize, count: usize) -> Vec<Cursor<'a>> {
        self.parts_after(None, size, count)
    }

    /// Splits the lines behind `part` as [`parts`](Self::parts) does; `None` splits the lines behind this cursor.
    pub(crate) fn parts_after(
        &self,
        part: Option<&Cursor<'_>>,
        size: usize,
        count: usize,
    ) -> Vec<Cursor<'a>> {
        let mut at = part.map_or_else(|| self.next_line(), |part| part.bytes.len());
        let mut parts = Vec::with_capacity(count);
        while parts.len() < count && at < self.bytes.len() {
            let end = self.part_end(self.bytes.len().min(at + size - 1));
            let bytes = &self.bytes[..end];
            parts.push(Cursor { bytes, at, line: 0, last_taken: None, ..*self });
            at = end;
        }
        parts
    }

    /// Moves to the last line of `part`, whose rows were all read. `part` must start at the cursor's next line, as the
    /// first of [`parts`](Self::parts) does.
    pub(crate) fn skip(&mut self, part: &Cursor<'_>) {
        self.line += part.line;
        self.at = part.bytes.len() - usize::from(part.bytes.ends_with(b"\n"));
    }

    /// Returns the location for messages: the current line, or the file's last line if no row follows. In a binary
    /// file, the location is the offset of the bytes taken last, or of the cursor inside a line.
    pub(crate) fn location(&self) -> Location {
        match self.last_taken {
            // Before the first line, `line` is 0, but editors count from 1.
            None if self.syntax.joins_lines || self.syntax.continues_cards => {
                Location::Line(self.source.line_of(self.at))
            }
            None => Location::Line(self.line.max(1)),
            Some(start) if self.line == 0 => Location::Byte(start),
            Some(_) => Location::Byte(self.at),
        }
    }

    /// Returns the location of the byte at offset `at`: a line in text files, an offset in binary files.
    pub(crate) fn location_of(&self, at: usize) -> Location {
        match self.last_taken {
            None => Location::Line(self.source.line_of(at)),
            Some(_) => Location::Byte(at),
        }
    }

    /// Takes `count` bytes, starting at the next line or behind the bytes taken last. The file then counts as binary.
    /// `None` if fewer bytes remain.
    #[inline]
    pub(crate) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let start = self.next_line();
        (self.at, self.line, self.last_taken) = (start, 0, Some(start));
        let taken = self.bytes[start..].get(..count)?;
        self.at += count;
        Some(taken)
    }

    /// Returns the next `count` items of `size` bytes, without moving the cursor, and the offset of the first item.
    /// `None` if fewer bytes remain.
    pub(crate) fn peek(&self, count: u64, size: usize) -> Option<(&'a [u8], usize)> {
        let start = self.next_line();
        let length = usize::try_from(count).ok()?.checked_mul(size)?;
        Some((self.bytes[start..].get(..length)?, start))
    }

    /// Moves to the byte at offset `at`, and updates the line number. Forward moves take time in proportion to the
    /// distance, backward moves in proportion to `at`.
    pub(crate) fn seek(&mut self, at: usize) {
        match self.last_taken {
            Some(_) => self.last_taken = Some(at),
            None if at < self.at || self.line == 0 => self.line = self.source.line_of(at),
            None => self.line += memchr::memchr_iter(b'\n', &self.bytes[self.at..at]).count(),
        }
        self.at = at;
    }

    /// Returns whether more than 2^18 bytes follow, enough to read faster on several threads.
    pub(crate) fn is_long(&self) -> bool {
        self.bytes.len() - self.at > 1 << 18
    }

    /// Skips `count` bytes, which must exist. [`last_taken`](Self::last_taken) is unchanged.
    pub(crate) fn skip_bytes(&mut self, count: usize) {
        self.at += count;
    }

    /// Returns the offset from which [`take`](Self::take) takes bytes.
    pub(crate) fn at_byte(&self) -> usize {
        self.next_line()
    }

    /// Returns the offset of the bytes taken last; in a text file, the cursor's offset.
    #[inline]
    pub(crate) fn last_taken(&self) -> usize {
        self.last_taken.unwrap_or(self.at)
    }

    #[inline]
    fn next_line(&self) -> usize {
        if self.line > 0 { self.row_end(self.at) } else { self.at }
    }

    /// Returns the end, behind the line feed, of the line with the byte at offset `at` and of its continuation lines.
    #[inline]
    pub(crate) fn row_end(&self, at: usize) -> usize {
        let end = line_end(self.bytes, at);
        match (self.syntax.joins_lines, self.syntax.continues_cards) {
            (false, false) => end,
            (true, _) => self.joined_end(at, end),
            // A comment has no continuation lines. Otherwise each of many comments would scan all following comments,
            // in quadratic time.
            (_, true) if is_left_out(self.bytes, at, self.syntax.comment) => end,
            (_, true) => continued_end(self.bytes, end, self.syntax.comment),
        }
    }

    /// Returns the byte range of the current row, from the start of the cursor's line.
    pub(crate) fn row_range(&self) -> Range<usize> {
        let start = memchr::memrchr(b'\n', &self.bytes[..self.at]).map_or(0, |before| before + 1);
        start.max(self.source.begin())..self.row_end(self.at)
    }

    /// Returns the end of the row around the byte at offset `at`, even if a comment between the row's lines holds the
    /// byte.
    fn part_end(&self, at: usize) -> usize {
        match self.syntax.continues_cards {
            true => continued_end(self.bytes, line_end(self.bytes, at), self.syntax.comment),
            false => self.row_end(at),
        }
    }

    #[cold]
    fn joined_end(&self, mut at: usize, mut end: usize) -> usize {
        while self.bytes[at..end].trim_ascii_end().ends_with(b"\\")
            && memchr::memchr(b'#', &self.bytes[at..end]).is_none()
        {
            (at, end) = (end, line_end(self.bytes, end));
        }
        end
    }

    /// Skips separators from `at` on, and returns the offset of the next other byte.
    #[inline]
    pub(crate) fn skip_blanks(&self, mut at: usize) -> usize {
        let bytes = self.bytes;
        while at < bytes.len() && bytes[at] <= b' ' && bytes[at] != b'\n' {
            at += 1;
        }
        let is_plain = self.syntax.is_plain && !self.crosses_line_ends;
        if is_plain || !self.is_word_end(at) { at } else { self.skip_more(at) }
    }

    #[cold]
    fn skip_more(&self, mut at: usize) -> usize {
        let separator = match self.syntax.commas {
            Commas::Blanks => Some(b','),
            Commas::Semicolons => Some(b';'),
            Commas::Letters | Commas::Trailing => None,
        };
        let mut is_separated = false;
        while let Some(&byte) = self.bytes.get(at) {
            match byte {
                _ if Some(byte) == separator && !is_separated => is_separated = true,
                b'\\' if self.syntax.joins_lines => {
                    let end = line_end(self.bytes, at);
                    match self.bytes[at + 1..end].trim_ascii().is_empty() {
                        true => at = end - 1,
                        false => return at,
                    }
                }
                b'#' if self.crosses_line_ends => at = line_end(self.bytes, at) - 1,
                b'\n' if self.crosses_line_ends => {}
                0..=b' ' if byte != b'\n' => {}
                _ => return at,
            }
            at += 1;
        }
        at
    }

    /// Returns the exclusive end of the word that starts at `at`.
    #[inline]
    pub(crate) fn word_end(&self, mut at: usize) -> usize {
        while at < self.bytes.len() && !self.syntax.ends_before(self.bytes[at]) {
            at += 1;
        }
        at
    }

    /// Returns whether the byte at `at` cannot continue a word; true at the end of `bytes`.
    #[inline]
    pub(crate) fn is_word_end(&self, at: usize) -> bool {
        self.bytes.get(at).is_none_or(|&byte| self.syntax.ends_before(byte))
    }

    /// Moves to the first token of the next row. Returns false if no row follows.
    pub(crate) fn next_row(&mut self) -> bool {
        let bytes = self.bytes;
        loop {
            self.at = self.next_line();
            if self.at == bytes.len() {
                return false;
            }
            self.line += 1;
            self.at = self.skip_blanks(self.at);
            match bytes.get(self.at) {
                None | Some(b'\n' | b'#') => {}
                Some(&first) if first == self.syntax.comment => {}
                Some(_) => return true,
            }
        }
    }

    /// Moves to the next item of a list: to the next row or, for [`Items::Words`], the next word. If the file ends, the
    /// error reports `done` of `count` items, which `what` names.
    #[inline]
    pub(crate) fn row(&mut self, done: u64, count: u64, what: &str) -> Result<(), ReadError> {
        if (self.syntax.items == Items::Words && self.is_within_row()) || self.next_row() {
            return Ok(());
        }
        Err(self.error(format!("the file ends after {done} of {count} {what}"), CUT_OFF))
    }

    /// Takes the next line without blanks at its end, even a blank line or a comment. `None` at the end of the file.
    pub(crate) fn line(&mut self) -> Option<&'a [u8]> {
        let start = self.next_line();
        if start == self.bytes.len() {
            return None;
        }
        let end = line_end(self.bytes, start);
        self.line += 1;
        // The cursor stays on the line feed, behind which the next line starts.
        self.at = end - usize::from(self.bytes[..end].ends_with(b"\n"));
        Some(self.bytes[start..end].trim_ascii_end())
    }

    /// Takes the rest of the row, trimmed of blanks at both ends.
    pub(crate) fn rest(&mut self) -> &'a [u8] {
        let end = self.row_end(self.at);
        let rest = self.bytes[self.at..end].trim_ascii();
        self.at = end - usize::from(self.bytes[..end].ends_with(b"\n"));
        rest
    }

    /// Returns whether the next token of the row starts with an ASCII letter.
    pub(crate) fn is_at_letter(&self) -> bool {
        self.bytes.get(self.skip_blanks(self.at)).is_some_and(u8::is_ascii_alphabetic)
    }

    /// Returns the offset of the row's next token, or of the row's end.
    pub(crate) fn at(&self) -> usize {
        self.skip_blanks(self.at)
    }

    /// Returns whether the row has no token left.
    #[inline]
    pub(crate) fn is_at_end(&self) -> bool {
        let at = self.skip_blanks(self.at);
        self.is_word_end(at)
    }

    /// Returns whether the current row has words left.
    fn is_within_row(&self) -> bool {
        self.line > 0 && !self.is_at_end()
    }

    /// Returns whether the following items may be read row by row: false if items are words and the current row has
    /// words left.
    pub(crate) fn is_between_rows(&self) -> bool {
        self.syntax.items != Items::Words || !self.is_within_row()
    }

    /// Reads an item at the cursor. If the row is too short for the item and the syntax allows, the item continues on
    /// later rows. In a list of words, `missing` then stores the error of the first short row, which may lack a number.
    pub(crate) fn item<T>(
        &mut self,
        mut read: impl FnMut(&mut Cursor<'a>) -> Result<T, ReadError>,
        missing: &mut Option<ReadError>,
    ) -> Result<T, ReadError> {
        let mut longer = self.clone();
        let error = match read(self) {
            Err(error) if self.syntax.items != Items::Rows => error,
            on_row => return on_row,
        };
        longer.crosses_line_ends = true;
        let read = read(&mut longer);
        longer.crosses_line_ends = false;
        match self.syntax.items {
            // If tokens follow the item on its last row, the first row lacks a number.
            Items::Records if read.is_err() || !longer.is_at_end() => return Err(error),
            Items::Words if read.is_err() => return read,
            Items::Words if missing.is_none() => *missing = Some(error),
            _ => {}
        }
        longer.line = self.line;
        self.seek(longer.at);
        read
    }

    /// Moves to the next token of the file, on this row or a later row. Returns false at the end of the file.
    #[inline]
    pub(crate) fn next_word(&mut self) -> bool {
        self.is_within_row() || self.next_row()
    }

    /// Takes the next token of the row. `None` at the end of the row.
    #[inline]
    pub(crate) fn token(&mut self) -> Option<&'a [u8]> {
        let bytes = self.bytes;
        let start = self.skip_blanks(self.at);
        self.at = self.word_end(start);
        let word = &bytes[start..self.at];
        let word = match self.syntax.commas {
            Commas::Trailing => word.strip_suffix(b",").unwrap_or(word),
            _ => word,
        };
        (!word.is_empty()).then_some(word)
    }

    /// Takes the next word of the row up to a blank, as a name: bytes that start comments behind numbers are part of the
    /// name. `None` at the end of the row.
    pub(crate) fn name(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.skip_blanks(self.at)..];
        let length = rest.iter().position(|&byte| matches!(byte, 1..=b' ')).unwrap_or(rest.len());
        self.at = self.bytes.len() - rest.len() + length;
        (length > 0).then_some(&rest[..length])
    }

    /// Takes up to `count` tokens of the row, and returns the bytes from the first token to the last, separators
    /// included.
    pub(crate) fn tokens(&mut self, count: u64) -> &'a [u8] {
        let bytes = self.bytes;
        let start = self.skip_blanks(self.at);
        let mut end = start;
        for _ in 0..count {
            if self.token().is_none() {
                break;
            }
            end = self.at;
        }
        &bytes[start..end]
    }

    /// Returns whether the next token starts with `byte`.
    pub(crate) fn is_at(&self, byte: u8) -> bool {
        self.bytes.get(self.skip_blanks(self.at)) == Some(&byte)
    }

    /// Returns the number of rows to reserve memory for: `count`, limited to rows of `bytes_per_row` bytes in the rest
    /// of the file, as damaged files announce wrong counts.
    pub(crate) fn capacity(&self, count: u64, bytes_per_row: usize) -> usize {
        let possible = (self.bytes.len() - self.at) / bytes_per_row;
        usize::try_from(count).map_or(possible, |count| count.min(possible))
    }

    /// Makes an error at the current location.
    #[cold]
    pub(crate) fn error(&self, problem: impl Into<String>, remedy: impl Into<String>) -> ReadError {
        self.source.error_at(self.location(), problem, remedy)
    }
}

#[cfg(test)]
#[path = "cursor_tests.rs"]
pub(crate) mod tests;
