//! Rows and tokens of a text file.

use crate::disk::source::Source;
use crate::error::{Location, ReadError};
use crate::text::continuation::{continued_end, is_left_out};
use crate::text::syntax::{Commas, Items, Syntax};
use crate::text::token::line_end;
use std::ops::Range;

/// The remedy for a single wrong line.
pub(crate) const CORRECT: &str = "Correct the line, or write the mesh again";
/// The remedy for a file that ends too early.
pub(crate) const CUT_OFF: &str = "The file is cut off: copy it again, or write the mesh again";

/// Walks over the rows of a file: the lines that have more than blanks and a comment. In a binary file it also takes
/// bytes between lines.
#[derive(Clone)]
pub(crate) struct Cursor<'a> {
    pub(crate) source: &'a Source,
    /// The source's bytes, up to the end of the cursor's range.
    pub(crate) bytes: &'a [u8],
    pub(crate) at: usize,
    /// How many lines were begun. 0 before the first line and after bytes were taken, when the next line starts at
    /// `at`.
    line: usize,
    /// The offset of the bytes taken last. `None` in a text file.
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

    /// Makes a cursor before the first row of a range, beyond which it does not read.
    pub(crate) fn within(source: &'a Source, range: Range<usize>) -> Self {
        let mut cursor = Cursor::on_line_of(source, range.start);
        cursor.bytes = &source.bytes[..range.end];
        cursor
    }

    /// Returns the cursor with another syntax.
    pub(crate) fn with_syntax(self, syntax: Syntax) -> Self {
        Cursor { syntax, ..self }
    }

    /// Splits the lines that follow into parts of about `size` bytes, at most `count` of them. Each part counts lines
    /// from its own first.
    pub(crate) fn parts(&self, size: usize, count: usize) -> Vec<Cursor<'a>> {
        self.parts_after(None, size, count)
    }

    /// Splits the lines after `part` as [`parts`](Self::parts) does, or the lines after this cursor for `None`.
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

    /// Moves to the last line of a part whose rows were all read. It must be the first of [`parts`](Self::parts).
    pub(crate) fn skip(&mut self, part: &Cursor<'_>) {
        self.line += part.line;
        self.at = part.bytes.len() - usize::from(part.bytes.ends_with(b"\n"));
    }

    /// Returns the location: the current line, or the last one if there are no more rows. In a binary file, it is the
    /// offset of the bytes taken last.
    pub(crate) fn location(&self) -> Location {
        match self.last_taken {
            // The count is 0 if nothing was read so far, but editors count from 1.
            None if self.syntax.joins_lines || self.syntax.continues_cards => {
                Location::Line(self.source.line_of(self.at))
            }
            None => Location::Line(self.line.max(1)),
            Some(start) if self.line == 0 => Location::Byte(start),
            Some(_) => Location::Byte(self.at),
        }
    }

    /// Returns the location of the byte at offset `at`.
    pub(crate) fn location_of(&self, at: usize) -> Location {
        match self.last_taken {
            None => Location::Line(self.source.line_of(at)),
            Some(_) => Location::Byte(at),
        }
    }

    /// Takes `count` bytes from the start of the next line, or after the bytes taken last. From then on the file counts
    /// as binary. `None` if there are fewer.
    #[inline]
    pub(crate) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let start = self.next_line();
        (self.at, self.line, self.last_taken) = (start, 0, Some(start));
        let taken = self.bytes[start..].get(..count)?;
        self.at += count;
        Some(taken)
    }

    /// Returns the next `count` items of `size` bytes, without taking them, and the offset of the first item. `None`
    /// if the file has fewer.
    pub(crate) fn peek(&self, count: u64, size: usize) -> Option<(&'a [u8], usize)> {
        let start = self.next_line();
        let length = usize::try_from(count).ok()?.checked_mul(size)?;
        Some((self.bytes[start..].get(..length)?, start))
    }

    /// Moves to the byte at offset `at`, for messages, and counts the lines up to the byte. Moving forward takes time
    /// in proportion to the distance.
    pub(crate) fn seek(&mut self, at: usize) {
        match self.last_taken {
            Some(_) => self.last_taken = Some(at),
            None if at < self.at || self.line == 0 => self.line = self.source.line_of(at),
            None => self.line += memchr::memchr_iter(b'\n', &self.bytes[self.at..at]).count(),
        }
        self.at = at;
    }

    /// Whether enough text follows that reading it on several threads pays.
    pub(crate) fn is_long(&self) -> bool {
        self.bytes.len() - self.at > 1 << 18
    }

    /// Skips `count` bytes, which must exist, without counting them as taken.
    pub(crate) fn skip_bytes(&mut self, count: usize) {
        self.at += count;
    }

    /// Returns the offset of the bytes that would be taken next.
    pub(crate) fn at_byte(&self) -> usize {
        self.next_line()
    }

    /// Returns the offset of the bytes taken last.
    #[inline]
    pub(crate) fn last_taken(&self) -> usize {
        self.last_taken.unwrap_or(self.at)
    }

    #[inline]
    fn next_line(&self) -> usize {
        if self.line > 0 { self.row_end(self.at) } else { self.at }
    }

    /// Returns the end of the line that has this byte, and of lines joined to it, after the line feed.
    #[inline]
    pub(crate) fn row_end(&self, at: usize) -> usize {
        let end = line_end(self.bytes, at);
        match (self.syntax.joins_lines, self.syntax.continues_cards) {
            (false, false) => end,
            (true, _) => self.joined_end(at, end),
            // A comment does not go on. If it did, each of many would look at all that follow.
            (_, true) if is_left_out(self.bytes, at, self.syntax.comment) => end,
            (_, true) => continued_end(self.bytes, end, self.syntax.comment),
        }
    }

    /// Returns the range of the current row, from the start of its first line on.
    pub(crate) fn row_range(&self) -> Range<usize> {
        let start = memchr::memrchr(b'\n', &self.bytes[..self.at]).map_or(0, |before| before + 1);
        start.max(self.source.begin())..self.row_end(self.at)
    }

    /// Returns the end of the row that has this byte, or that has lines before and after this one.
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

    /// Returns the first offset from `at` on whose byte is not a separator.
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

    /// Returns the end of the word that starts at `at`.
    #[inline]
    pub(crate) fn word_end(&self, mut at: usize) -> usize {
        while at < self.bytes.len() && !self.syntax.ends_before(self.bytes[at]) {
            at += 1;
        }
        at
    }

    /// Whether a word ends before `at`.
    #[inline]
    pub(crate) fn is_word_end(&self, at: usize) -> bool {
        self.bytes.get(at).is_none_or(|&byte| self.syntax.ends_before(byte))
    }

    /// Moves to the first token of the next row. Returns false if there is none.
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

    /// Moves to the next of `count` items, after `done` were read: to the next row, or to the next word if items do not
    /// keep to rows.
    #[inline]
    pub(crate) fn row(&mut self, done: u64, count: u64, what: &str) -> Result<(), ReadError> {
        if (self.syntax.items == Items::Words && self.is_within_row()) || self.next_row() {
            return Ok(());
        }
        Err(self.error(format!("the file ends after {done} of {count} {what}"), CUT_OFF))
    }

    /// Takes the next line whole, without its end, even if it is blank or a comment.
    pub(crate) fn line(&mut self) -> Option<&'a [u8]> {
        let start = self.next_line();
        if start == self.bytes.len() {
            return None;
        }
        let end = line_end(self.bytes, start);
        self.line += 1;
        // The cursor stays on the line feed, so that the next line is the one after it.
        self.at = end - usize::from(self.bytes[..end].ends_with(b"\n"));
        Some(self.bytes[start..end].trim_ascii_end())
    }

    /// Takes the rest of the row, without the blanks around it.
    pub(crate) fn rest(&mut self) -> &'a [u8] {
        let end = self.row_end(self.at);
        let rest = self.bytes[self.at..end].trim_ascii();
        self.at = end - usize::from(self.bytes[..end].ends_with(b"\n"));
        rest
    }

    /// Whether the next token of the row starts with a letter.
    pub(crate) fn is_at_letter(&self) -> bool {
        self.bytes.get(self.skip_blanks(self.at)).is_some_and(u8::is_ascii_alphabetic)
    }

    /// Returns the offset of the row's next token.
    pub(crate) fn at(&self) -> usize {
        self.skip_blanks(self.at)
    }

    /// Whether the row has no token left.
    #[inline]
    pub(crate) fn is_at_end(&self) -> bool {
        let at = self.skip_blanks(self.at);
        self.is_word_end(at)
    }

    /// Whether the current row has words left.
    fn is_within_row(&self) -> bool {
        self.line > 0 && !self.is_at_end()
    }

    /// Whether the items that follow may be read row by row.
    pub(crate) fn is_between_rows(&self) -> bool {
        self.syntax.items != Items::Words || !self.is_within_row()
    }

    /// Reads an item that starts here. If it does not fit on the row and the syntax allows it, the item continues on
    /// later rows. In a list of words, `missing` then keeps the error of the row, as a number may be missing there.
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
            // If another item starts on the row that this one would end on, a number is missing.
            Items::Records if read.is_err() || !longer.is_at_end() => return Err(error),
            Items::Words if read.is_err() => return read,
            Items::Words if missing.is_none() => *missing = Some(error),
            _ => {}
        }
        longer.line = self.line;
        self.seek(longer.at);
        read
    }

    /// Moves before the next token of the file, on this row or a later one. Returns false if there is none.
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

    /// Takes up to `count` tokens of the row, with what stands between them.
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

    /// Whether the next token starts with this byte.
    pub(crate) fn is_at(&self, byte: u8) -> bool {
        self.bytes.get(self.skip_blanks(self.at)) == Some(&byte)
    }

    /// Returns for how many of `count` rows to reserve memory: no more than the rest of the file can hold, as the count
    /// may be wrong.
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
