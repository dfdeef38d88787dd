//! Rows and tokens of a text file.

use crate::error::{Location, ReadError};
use crate::file::source::Source;
use crate::file::token::{float, integer, line_end, quoted, skip_blanks, token_end};
use std::fmt::Display;
use std::ops::Range;

/// What to do about a single wrong line.
pub(crate) const CORRECT: &str = "Correct the line, or write the mesh again";
/// What to do about a file that stops too early.
pub(crate) const CUT_OFF: &str = "The file is cut off: copy it again, or write the mesh again";
const WHOLE: &str = "a whole number from 0 to 2^64-1";
const SIGNED: &str = "a whole number from -2^63 to 2^63-1";

/// Walks over the rows of a file, which are the lines that hold more than blanks and a `#` comment. In a binary file it
/// takes bytes between the lines.
#[derive(Clone)]
pub(crate) struct Cursor<'a> {
    pub(crate) source: &'a Source,
    /// The source's bytes up to where this cursor ends.
    bytes: &'a [u8],
    at: usize,
    /// How many lines were begun. Zero before the first one and after bytes were taken: then the next line starts at
    /// `at`.
    line: usize,
    /// Where the bytes last taken start. None in a text file.
    taken: Option<usize>,
    /// What, besides `#`, starts a line that is no row.
    comment: u8,
}

impl<'a> Cursor<'a> {
    /// Stands before the first row.
    pub(crate) fn new(source: &'a Source) -> Self {
        let at = source.begin();
        Cursor { source, bytes: &source.bytes, at, line: 0, taken: None, comment: b'#' }
    }

    /// Stands on the line of a byte, for messages.
    pub(crate) fn standing_at(source: &'a Source, at: usize) -> Self {
        let mut cursor = Cursor::new(source);
        (cursor.at, cursor.line) = (at, source.line_of(at));
        cursor
    }

    /// Stands before a byte of a binary file, for messages.
    pub(crate) fn at_byte_of(source: &'a Source, at: usize) -> Self {
        let mut cursor = Cursor::new(source);
        (cursor.at, cursor.taken) = (at, Some(at));
        cursor
    }

    /// Stands before the first row of a range of the file, of which it sees no more.
    pub(crate) fn within(source: &'a Source, range: Range<usize>) -> Self {
        let mut cursor = Cursor::standing_at(source, range.start);
        cursor.bytes = &source.bytes[..range.end];
        cursor
    }

    /// Lines that start with this byte are no rows either.
    pub(crate) fn with_comments(self, comment: u8) -> Self {
        Cursor { comment, ..self }
    }

    /// Splits the lines that follow among cursors of about `size` bytes each, `count` of them at most. Each counts lines
    /// from its own first.
    pub(crate) fn parts(&self, size: usize, count: usize) -> Vec<Cursor<'a>> {
        self.parts_after(None, size, count)
    }

    /// Splits the lines that follow a part in the same way; those that follow this cursor if it is none.
    pub(crate) fn parts_after(
        &self,
        part: Option<&Cursor<'_>>,
        size: usize,
        count: usize,
    ) -> Vec<Cursor<'a>> {
        let mut at = part.map_or_else(|| self.next_line(), |part| part.bytes.len());
        let mut parts = Vec::with_capacity(count);
        while parts.len() < count && at < self.bytes.len() {
            let end = line_end(self.bytes, self.bytes.len().min(at + size - 1));
            let bytes = &self.bytes[..end];
            parts.push(Cursor { bytes, at, line: 0, taken: None, ..*self });
            at = end;
        }
        parts
    }

    /// Moves to the last line of a part, all rows of which were read. It has to be the first one of
    /// [`parts`](Self::parts).
    pub(crate) fn skip(&mut self, part: &Cursor<'_>) {
        self.line += part.line;
        self.at = part.bytes.len() - usize::from(part.bytes.ends_with(b"\n"));
    }

    /// Where it stands: on a line, the last one if there are no more rows, or in a binary file at the start of the bytes
    /// last taken.
    pub(crate) fn location(&self) -> Location {
        match self.taken {
            // Zero if nothing was read so far, but editors count from one.
            None => Location::Line(self.line.max(1)),
            Some(start) if self.line == 0 => Location::Byte(start),
            Some(_) => Location::Byte(self.at),
        }
    }

    /// The location of what starts at the byte `at`.
    pub(crate) fn location_of(&self, at: usize) -> Location {
        match self.taken {
            None => Location::Line(self.source.line_of(at)),
            Some(_) => Location::Byte(at),
        }
    }

    /// Takes so many bytes from the start of the next line, or from where those last taken end. From then on the file
    /// counts as binary. None if there are fewer.
    #[inline]
    pub(crate) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let start = self.next_line();
        (self.at, self.line, self.taken) = (start, 0, Some(start));
        let taken = self.bytes[start..].get(..count)?;
        self.at += count;
        Some(taken)
    }

    /// The bytes of so many items that [`take`](Self::take) would take next, and where they start. None if there are fewer.
    pub(crate) fn ahead(&self, count: u64, size: usize) -> Option<(&'a [u8], usize)> {
        let start = self.next_line();
        let length = usize::try_from(count).ok()?.checked_mul(size)?;
        Some((self.bytes[start..].get(..length)?, start))
    }

    /// Moves to a byte of the whole file, for messages, and there counts the line it stands on. Quick where it moves forward.
    pub(crate) fn go_to(&mut self, at: usize) {
        match self.taken {
            Some(_) => self.taken = Some(at),
            None if at < self.at || self.line == 0 => self.line = self.source.line_of(at),
            None => self.line += memchr::memchr_iter(b'\n', &self.bytes[self.at..at]).count(),
        }
        self.at = at;
    }

    /// Whether so much follows that it is worth reading on several threads.
    pub(crate) fn is_long(&self) -> bool {
        self.bytes.len() - self.at > 1 << 18
    }

    /// Passes over bytes that are there, without counting them as taken.
    pub(crate) fn pass(&mut self, count: usize) {
        self.at += count;
    }

    /// Where the bytes start that are taken next.
    pub(crate) fn at_byte(&self) -> usize {
        self.next_line()
    }

    /// Where the bytes last taken start.
    #[inline]
    pub(crate) fn taken(&self) -> usize {
        self.taken.unwrap_or(self.at)
    }

    #[inline]
    fn next_line(&self) -> usize {
        if self.line > 0 { line_end(self.bytes, self.at) } else { self.at }
    }

    /// Moves to the first token of the next row. False when there is none.
    pub(crate) fn next_row(&mut self) -> bool {
        let bytes = self.bytes;
        loop {
            self.at = self.next_line();
            if self.at == bytes.len() {
                return false;
            }
            self.line += 1;
            self.at = skip_blanks(bytes, self.at);
            match bytes.get(self.at) {
                None | Some(b'\n' | b'#') => {}
                Some(&first) if first == self.comment => {}
                Some(_) => return true,
            }
        }
    }

    /// Moves to the next of `count` rows, `done` of which were read.
    #[inline]
    pub(crate) fn row(&mut self, done: u64, count: u64, what: &str) -> Result<(), ReadError> {
        if self.next_row() {
            return Ok(());
        }
        Err(self.error(format!("the file ends after {done} of {count} {what}"), CUT_OFF))
    }

    /// Takes the next line whole, without what ends it, be it a row or not.
    pub(crate) fn line(&mut self) -> Option<&'a [u8]> {
        let start = self.next_line();
        if start == self.bytes.len() {
            return None;
        }
        let end = line_end(self.bytes, start);
        self.line += 1;
        // On the line feed, so that the next line is the one after it.
        self.at = end - usize::from(self.bytes[..end].ends_with(b"\n"));
        Some(self.bytes[start..end].trim_ascii_end())
    }

    /// The rest of the row, without blanks around it.
    pub(crate) fn rest(&mut self) -> &'a [u8] {
        let end = line_end(self.bytes, self.at);
        let rest = self.bytes[self.at..end].trim_ascii();
        self.at = end - usize::from(self.bytes[..end].ends_with(b"\n"));
        rest
    }

    /// Whether the next token of the row starts with a letter.
    pub(crate) fn is_at_letter(&self) -> bool {
        self.bytes.get(skip_blanks(self.bytes, self.at)).is_some_and(u8::is_ascii_alphabetic)
    }

    /// Where the next token of the row starts.
    pub(crate) fn at(&self) -> usize {
        skip_blanks(self.bytes, self.at)
    }

    /// Whether the row has no token left.
    #[inline]
    pub(crate) fn is_at_end(&self) -> bool {
        let at = skip_blanks(self.bytes, self.at);
        token_end(self.bytes, at) == at
    }

    /// Moves before the next token of the file, on this row or a later one. False when there is none.
    #[inline]
    pub(crate) fn next_word(&mut self) -> bool {
        (self.line > 0 && !self.is_at_end()) || self.next_row()
    }

    /// The next token of the row, or none at its end.
    #[inline]
    pub(crate) fn token(&mut self) -> Option<&'a [u8]> {
        let bytes = self.bytes;
        let start = skip_blanks(bytes, self.at);
        self.at = token_end(bytes, start);
        (self.at > start).then(|| &bytes[start..self.at])
    }

    /// The next tokens of the row, as many as there are up to `count`, with what stands between them.
    pub(crate) fn tokens(&mut self, count: u64) -> &'a [u8] {
        let bytes = self.bytes;
        let start = skip_blanks(bytes, self.at);
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
        self.bytes.get(skip_blanks(self.bytes, self.at)) == Some(&byte)
    }

    /// Reads a number from zero up, called `what` in messages.
    #[inline]
    pub(crate) fn integer(&mut self, what: impl Display) -> Result<u64, ReadError> {
        let bytes = self.bytes;
        let start = skip_blanks(bytes, self.at);
        let mut at = start;
        let mut number = 0_u64;
        while let Some(&digit @ b'0'..=b'9') = bytes.get(at) {
            number = number.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
            at += 1;
        }
        // So many digits cannot overflow. The rest is rare.
        if (1..=19).contains(&(at - start)) && token_end(bytes, at) == at {
            self.at = at;
            return Ok(number);
        }
        let token = self.token();
        token.and_then(integer).ok_or_else(|| self.unusable(token, what, WHOLE))
    }

    /// Reads a number that may be negative, called `what` in messages.
    #[inline]
    pub(crate) fn signed(&mut self, what: impl Display) -> Result<i64, ReadError> {
        let bytes = self.bytes;
        let start = skip_blanks(bytes, self.at);
        let first = start + usize::from(bytes.get(start) == Some(&b'-'));
        let mut at = first;
        let mut number = 0_i64;
        while let Some(&digit @ b'0'..=b'9') = bytes.get(at) {
            number = number.wrapping_mul(10).wrapping_add(i64::from(digit - b'0'));
            at += 1;
        }
        // So many digits cannot overflow. The rest is rare.
        if (1..=18).contains(&(at - first)) && token_end(bytes, at) == at {
            self.at = at;
            return Ok(if first > start { -number } else { number });
        }
        let token = self.token();
        let number = token.and_then(|token| str::from_utf8(token).ok()?.parse().ok());
        number.ok_or_else(|| self.unusable(token, what, SIGNED))
    }

    /// Like [`integer`](Self::integer), but `absent` stands for a missing token.
    pub(crate) fn integer_or(&mut self, absent: u64, what: &str) -> Result<u64, ReadError> {
        match self.token() {
            None => Ok(absent),
            token => token.and_then(integer).ok_or_else(|| self.unusable(token, what, WHOLE)),
        }
    }

    /// Reads how many vertices there are.
    pub(crate) fn vertex_count(&mut self) -> Result<u64, ReadError> {
        let count = self.integer("the number of vertices")?;
        self.check_vertex_count(count)?;
        Ok(count)
    }

    /// Fails where there are more vertices than 32-bit indices can tell apart.
    pub(crate) fn check_vertex_count(&self, count: u64) -> Result<(), ReadError> {
        if count > u64::from(u32::MAX) {
            let problem = format!("{count} vertices are announced, but at most {} fit", u32::MAX);
            return Err(self.error(problem, "Correct the count, or split the mesh"));
        }
        Ok(())
    }

    /// Reads one coordinate, `axis` of `owner` in messages.
    #[inline]
    pub(crate) fn coordinate(&mut self, axis: char, owner: impl Display) -> Result<f64, ReadError> {
        let token = self.token();
        let value = token.and_then(float).filter(|x| x.is_finite());
        value.ok_or_else(|| {
            self.unusable(token, format_args!("{axis} of {owner}"), "a finite number")
        })
    }

    /// Reads a number that need not be finite, called `what` in messages.
    pub(crate) fn real(&mut self, what: impl Display) -> Result<f64, ReadError> {
        let token = self.token();
        token.and_then(float).ok_or_else(|| self.unusable(token, what, "a number"))
    }

    /// Reads z, which need not be finite: programs write NaN where they know no depth. Returns where it stands, and z.
    #[inline]
    pub(crate) fn height(&mut self, owner: impl Display) -> Result<(usize, f64), ReadError> {
        Ok((self.at(), self.real(format_args!("z of {owner}"))?))
    }

    /// Reads x and y. Returns where x stands, and both.
    #[inline]
    pub(crate) fn point(
        &mut self,
        owner: impl Display + Copy,
    ) -> Result<(usize, [f64; 2]), ReadError> {
        let x_at = skip_blanks(self.bytes, self.at);
        Ok((x_at, [self.coordinate('x', owner)?, self.coordinate('y', owner)?]))
    }

    /// How many of `count` rows to reserve space for: not more than what follows can hold, as the count may be wrong.
    pub(crate) fn capacity(&self, count: u64, bytes_per_row: usize) -> usize {
        let possible = (self.bytes.len() - self.at) / bytes_per_row;
        usize::try_from(count).map_or(possible, |count| count.min(possible))
    }

    /// An error on the current line.
    #[cold]
    pub(crate) fn error(&self, problem: impl Into<String>, remedy: impl Into<String>) -> ReadError {
        self.source.error_at(self.location(), problem, remedy)
    }

    #[cold]
    fn unusable(&self, token: Option<&[u8]>, what: impl Display, wanted: &str) -> ReadError {
        match token {
            // Not even the end of the line follows.
            None if memchr::memchr(b'\n', &self.bytes[self.at..]).is_none() => {
                self.error(format!("{what} is missing"), CUT_OFF)
            }
            None => self.error(format!("{what} is missing"), CORRECT),
            Some(token) => {
                self.error(format!("{what} is `{}`, not {wanted}", quoted(token)), CORRECT)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &[u8]) -> Source {
        Source { path: "m.txt".into(), bytes: text.to_vec(), packed: None, welds: false }
    }

    fn row_of(source: &Source) -> Cursor<'_> {
        let mut cursor = Cursor::new(source);
        cursor.next_row();
        cursor
    }

    #[test]
    fn signed_integers() {
        let numbers = source(b"0 +17 -3 9223372036854775807 -9223372036854775808");
        let mut cursor = row_of(&numbers);
        for expected in [0, 17, -3, i64::MAX, i64::MIN] {
            assert_eq!(cursor.signed("a tag").unwrap(), expected);
        }
        for wrong in ["-", "--1", "1.0", "9223372036854775808", "7a", ""] {
            assert!(row_of(&source(wrong.as_bytes())).signed("a tag").is_err(), "{wrong}");
        }
    }

    #[test]
    fn tokens_are_taken_up_to_a_comment() {
        let row = source(b" 1 2\t 3 # 4\n5");
        let tokens = |count| row_of(&row).tokens(count);
        assert_eq!([0, 2, 9].map(tokens), [&b""[..], b"1 2", b"1 2\t 3"]);
    }

    #[test]
    fn rows_skip_blank_and_comment_lines_and_count_them() {
        let source = source(b"\xEF\xBB\xBF# one\r\n\r\n \t a  b # c\r\nd#e\n\n\xFF f");
        let mut cursor = Cursor::new(&source);
        let mut rows = Vec::new();
        while cursor.next_row() {
            let mut row = vec![cursor.line.to_string().into_bytes()];
            while let Some(token) = cursor.token() {
                row.push(token.to_vec());
            }
            rows.push(row.join(&b' '));
        }
        assert_eq!(rows, [&b"3 a b"[..], b"4 d", b"6 \xFF f"]);
        assert!(!cursor.next_row());
        assert_eq!(cursor.location(), Location::Line(6));
    }

    #[test]
    fn capacity_is_bounded_by_what_is_left() {
        let source = source(b"1 2 3 4 5 6\n");
        assert_eq!(Cursor::new(&source).capacity(u64::MAX, 4), 3);
        assert_eq!(Cursor::new(&source).capacity(2, 4), 2);
    }
}
