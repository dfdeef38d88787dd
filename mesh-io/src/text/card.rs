//! Lines and fields of Nastran's cards, the entries of its bulk data.
//!
//! In small field, a line has a name and eight data fields of 8 characters. In large field, with an asterisk after the
//! name, a line has four data fields of 16 characters. In free field, commas separate eight data fields, or four after
//! an asterisk. The last field of a line and the first field of the next line may name a continuation.

use memchr::{memchr, memchr2, memrchr};
use std::ops::Range;

/// Width in characters of a small field, and of the name and continuation fields in every fixed format.
const SMALL_FIELD_WIDTH: usize = 8;
/// Width in characters of a large field.
const LARGE_FIELD_WIDTH: usize = 16;
/// Number of leading characters of a line in which a comma marks free field.
const MAX_COMMA_COLUMN: usize = 10;

/// One line of a Nastran card.
#[derive(Clone, Copy)]
pub(crate) struct CardLine<'a> {
    bytes: &'a [u8],
    start: usize,
    /// Exclusive end of the fields: offset of the comment or, without a comment, of the line end.
    end: usize,
    pub(crate) is_free: bool,
    pub(crate) is_large: bool,
    has_tabs: bool,
}

/// Name of a card in capital letters, without an asterisk, padded with zero bytes.
pub(crate) type CardName = [u8; SMALL_FIELD_WIDTH];

/// Returns the name of a card without the zero bytes of the padding.
pub(crate) fn name_bytes(name: &CardName) -> &[u8] {
    &name[..memchr(0, name).unwrap_or(SMALL_FIELD_WIDTH)]
}

impl<'a> CardLine<'a> {
    /// Parses the line that starts at offset `start`.
    pub(crate) fn starting_at(bytes: &'a [u8], start: usize) -> CardLine<'a> {
        let rest = &bytes[start..];
        let rest = &rest[..memchr2(b'\n', b'$', rest).unwrap_or(rest.len())];
        let rest = rest.strip_suffix(b"\r").unwrap_or(rest);
        let is_free = memchr(b',', &rest[..rest.len().min(MAX_COMMA_COLUMN)]).is_some();
        let head = &rest[..rest.len().min(SMALL_FIELD_WIDTH)];
        let head = &head[..memchr(b',', head).unwrap_or(head.len())];
        let is_large = memchr(b'*', head).is_some();
        let has_tabs = !is_free && memchr(b'\t', rest).is_some();
        CardLine { bytes, start, end: start + rest.len(), is_free, is_large, has_tabs }
    }

    /// Parses the line with the byte at offset `at`.
    fn of(bytes: &'a [u8], at: usize) -> CardLine<'a> {
        let mark = if bytes.starts_with(b"\xEF\xBB\xBF") { 3 } else { 0 };
        let start = memrchr(b'\n', &bytes[..at]).map_or(mark, |before| before + 1);
        CardLine::starting_at(bytes, start.min(at))
    }

    /// Returns the content of the name field, which is meaningful only for the first line of a card.
    pub(crate) fn name(&self) -> CardName {
        let mut name = CardName::default();
        let letters = self.bytes[self.start..self.end].iter();
        let letters = letters.take_while(|byte| !matches!(byte, b',' | b'*' | 0..=b' '));
        for (to, letter) in name.iter_mut().zip(letters) {
            *to = letter.to_ascii_uppercase();
        }
        name
    }

    /// Returns the width of the line's data fields in characters. The line end may cut off the last field.
    fn width(&self) -> usize {
        if self.is_large { LARGE_FIELD_WIDTH } else { SMALL_FIELD_WIDTH }
    }

    /// Returns the number of data fields in a full line: 4 or 8.
    fn count(&self) -> usize {
        if self.is_large { 4 } else { 8 }
    }

    /// Returns the byte ranges of the line's data fields. In free field, ranges exclude blanks around the value; fixed
    /// fields have their full width.
    pub(crate) fn fields(self) -> Fields<'a> {
        let at = match self.is_free {
            true => self.comma_from(self.start),
            false => self.at_column(SMALL_FIELD_WIDTH),
        };
        Fields { line: self, at, index: 0 }
    }

    /// Returns the offset of the first comma at or behind `at`, or the line's end.
    fn comma_from(&self, at: usize) -> usize {
        memchr(b',', &self.bytes[at..self.end]).map_or(self.end, |comma| at + comma)
    }

    /// Returns the offset of the byte in a 0-based column, at most the line's end. A tab advances to the next multiple
    /// of eight columns.
    fn at_column(&self, column: usize) -> usize {
        if !self.has_tabs {
            return self.end.min(self.start + column);
        }
        let (mut at, mut passed) = (self.start, 0);
        while at < self.end && passed < column {
            passed = self.after(passed, at);
            at += 1;
        }
        at
    }

    /// Returns the 0-based column of the byte at offset `at`.
    fn column(&self, at: usize) -> usize {
        if !self.has_tabs {
            return at - self.start;
        }
        (self.start..at).fold(0, |column, at| self.after(column, at))
    }

    /// Returns the column behind the byte at offset `at`, given the byte's own `column`.
    fn after(&self, column: usize, at: usize) -> usize {
        if self.bytes[at] == b'\t' {
            (column / SMALL_FIELD_WIDTH + 1) * SMALL_FIELD_WIDTH
        } else {
            column + 1
        }
    }
}

/// Iterator over the byte ranges of a line's data fields.
pub(crate) struct Fields<'a> {
    line: CardLine<'a>,
    /// Offset of the comma before the next field (free field), or of the next field's start (fixed fields).
    at: usize,
    index: usize,
}

impl Iterator for Fields<'_> {
    type Item = Range<usize>;

    #[inline]
    fn next(&mut self) -> Option<Range<usize>> {
        let line = &self.line;
        loop {
            if self.at >= line.end {
                return None;
            }
            let index = self.index;
            self.index += 1;
            if line.is_free {
                let start = self.at + 1;
                self.at = line.comma_from(start);
                // A line in free field may hold the data of several lines, with the two continuation fields between
                // them.
                if index % (line.count() + 2) >= line.count() {
                    continue;
                }
                return Some(trimmed(line.bytes, start..self.at));
            }
            if index == line.count() {
                return None;
            }
            let start = self.at;
            self.at = match line.has_tabs {
                true => line.at_column(SMALL_FIELD_WIDTH + (index + 1) * line.width()),
                false => line.end.min(start + line.width()),
            };
            return Some(start..self.at);
        }
    }
}

/// Returns a range without the blanks at both ends. A range of blanks becomes an empty range at its start.
fn trimmed(bytes: &[u8], Range { mut start, mut end }: Range<usize>) -> Range<usize> {
    let is_blank = |at: usize| bytes[at] <= b' ';
    let all = start;
    while start < end && is_blank(start) {
        start += 1;
    }
    if start == end {
        return all..all;
    }
    while is_blank(end - 1) {
        end -= 1;
    }
    start..end
}

/// Returns the data fields of all lines of a card, without blanks around the values. Fields missing at the end of a
/// line are empty.
pub(crate) fn words(bytes: &[u8], card: Range<usize>) -> impl Iterator<Item = &[u8]> {
    lines(bytes, card).flat_map(move |line| {
        let count = line.count();
        let mut fields = line.fields();
        let mut given = 0;
        std::iter::from_fn(move || {
            let field = fields.next();
            let is_there = field.is_some() || given % count != 0 || given == 0;
            given += 1;
            is_there.then(|| field.map_or(&[][..], |field| bytes[field].trim_ascii()))
        })
    })
}

/// Returns the lines of a card, without comment lines and blank lines.
pub(crate) fn lines(bytes: &[u8], card: Range<usize>) -> impl Iterator<Item = CardLine<'_>> {
    let mut at = card.start;
    std::iter::from_fn(move || {
        while at < card.end {
            let start = at;
            at = memchr(b'\n', &bytes[start..card.end]).map_or(card.end, |end| start + end + 1);
            let text = bytes[start..at].trim_ascii_start();
            if !matches!(text.first(), None | Some(b'$' | b'#')) {
                return Some(CardLine::starting_at(bytes, start));
            }
        }
        None
    })
}

/// Returns the exclusive end of the field at offset `at`, and the width in characters to which a new value is padded.
/// The width is 0 in free field, and for a field that the line end cuts off.
pub(crate) fn extent(bytes: &[u8], at: usize) -> (usize, usize) {
    let line = CardLine::of(bytes, at);
    if line.is_free {
        let end = line.comma_from(at.min(line.end));
        return (trimmed(bytes, at.min(end)..end).end.max(at), 0);
    }
    let (column, width) = (line.column(at), line.width());
    let is_whole = line.column(line.end) >= column + width;
    (line.at_column(column + width).max(at), if is_whole { width } else { 0 })
}

/// Returns the start of the next field, given the exclusive end of a field.
pub(crate) fn next_field(bytes: &[u8], end: usize) -> usize {
    let line = CardLine::of(bytes, end);
    let comma = line.comma_from(end.min(line.end));
    match line.is_free && comma < line.end {
        true => trimmed(bytes, comma + 1..line.comma_from(comma + 1)).start,
        false => end,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(line: &str) -> Vec<&str> {
        let fields = CardLine::starting_at(line.as_bytes(), 0).fields();
        fields.map(|field| &line[field]).collect()
    }

    #[test]
    fn fields_are_found_in_every_form() {
        assert_eq!(fields("GRID, 1 ,,0.5 , -.5\t,  $ 7, 8"), ["1", "", "0.5", "-.5", ""]);
        assert_eq!(
            fields("GRID    1               0.123456780.12345678+A\r\n"),
            ["1       ", "        ", "0.123456", "780.1234", "5678+A"]
        );
        assert_eq!(
            fields("GRID*   1                               0.5             0.25"),
            ["1               ", "                ", "0.5             ", "0.25"]
        );
        assert_eq!(fields("grid\t1\t\t0.5\t.25\n"), ["1\t", "\t", "0.5\t", ".25"]);
        assert_eq!(fields("GRID*\t1\t\t\t\t0.5\t\t.25$"), ["1\t\t", "\t\t", "0.5\t\t", ".25"]);
        assert_eq!(fields("*  $"), [""; 0]);
        assert_eq!(
            fields("A,1,2,3,4,5,6,7,8,+,+,9"),
            ["1", "2", "3", "4", "5", "6", "7", "8", "9"]
        );
        assert_eq!(fields("A*,1,2,3,4,*C,*C,5"), ["1", "2", "3", "4", "5"]);
        assert_eq!(
            fields("CBAR    1       2       3       4       5       6       7       8       9")
                .len(),
            8
        );
        for (line, name) in [("\tGrid*, 1", ""), ("Grid*, 1", "GRID"), ("ctria3 *", "CTRIA3")] {
            let own = CardLine::starting_at(line.as_bytes(), 0).name();
            assert_eq!(name_bytes(&own), name.as_bytes());
        }
    }

    #[test]
    fn words_of_a_card_keep_their_places() {
        let words_of = |card: &'static str| -> Vec<&str> {
            let all = words(card.as_bytes(), 0..card.len());
            all.map(|word| str::from_utf8(word).unwrap()).collect()
        };
        let large = "CTRIA3* 7               1               2\n$ 5\n\n*       3               4\n";
        assert_eq!(words_of(large), ["7", "1", "2", "", "3", "4", "", ""]);
        assert_eq!(
            words_of("RBE2,1,2\n,3"),
            ["1", "2", "", "", "", "", "", "", "3", "", "", "", "", "", "", ""]
        );
        assert_eq!(words_of("X"), [""; 8]);
    }

    /// The start of a field determines its end and the next field, even if the field is empty.
    #[test]
    fn fields_are_found_again_from_their_starts() {
        for line in [
            "GRID,1,,0.5,-.5, 0. ",
            "GRID,1,, , ,",
            "GRID,1,,0.5 ,,$",
            "GRID    1               0.123456780.12345678",
            "GRID    1                        .5     1.\r",
            "GRID\t1\t\t0.5\t.25\t1.",
            "GRID*\t1\t\t\t\t0.5\t\t.25",
        ] {
            for head in ["", "$, comment\n", "\u{feff}"] {
                let text = format!("{head}{line}\nEND");
                let bytes = text.as_bytes();
                let all: Vec<_> = CardLine::starting_at(bytes, head.len()).fields().collect();
                for pair in all.windows(2) {
                    assert_eq!(extent(bytes, pair[0].start).0, pair[0].end, "{text:?}");
                    assert_eq!(next_field(bytes, pair[0].end), pair[1].start, "{text:?}");
                }
            }
        }
        assert_eq!(extent(b"GRID    1               .5      1.0", 24), (32, 8));
        assert_eq!(extent(b"GRID    1               .5      1.0", 32), (35, 0));
        assert_eq!(extent(b"GRID\t1\t\t.5\t1.", 8), (11, 8));
        assert_eq!(extent(b"*\t1.25\t\t7", 2), (8, 16));
    }
}
