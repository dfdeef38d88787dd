//! Rows of a file that the mesh itself tells: they are made again when they are written, rather than kept.
//!
//! The list of triangles is the larger half of a mesh's file, and its rows mostly differ in nothing but consecutive
//! numbers and the corners. A row is left out only if it was made again and found the same, byte for byte.

use super::binary::Order;
use super::patch::write_blocks;
use super::text::{integer, line_end, skip_blanks, token_end};
use rayon::prelude::*;
use std::io::{self, Write};
use std::ops::Range;

/// How much of a file one thread looks through at a time.
const CHUNK: usize = 1 << 20;
/// Shorter runs of rows are kept as they are.
const WORTH: usize = 32;
/// How many rows one thread makes at a time.
const BLOCK: usize = 4096;

/// How triangles and vertices are numbered, if consecutively.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Labels {
    /// Number or tag of the first triangle.
    pub(super) triangle: u64,
    /// Number or tag of the first vertex.
    pub(super) vertex: u64,
}

/// Rows of a binary file, each of one triangle: its number, and at its end its corners.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    /// Where they stand.
    pub(super) bytes: Range<usize>,
    /// The first triangle.
    pub(super) first: usize,
    /// Bytes of a row.
    pub(super) size: usize,
    /// Bytes before the triangle's number in a row.
    pub(super) number_at: usize,
    /// Bytes of a number.
    pub(super) width: usize,
}

/// What was left out of a file.
#[derive(Default)]
pub(super) struct Implied {
    labels: Labels,
    /// In the order of the file.
    gaps: Vec<Gap>,
}

/// Rows of consecutive triangles that were left out.
struct Gap {
    /// Where they belong in what is left of the file.
    at: usize,
    triangles: Range<usize>,
    form: Form,
}

/// Rows that can be left out.
struct Run {
    bytes: Range<usize>,
    triangles: Range<usize>,
    form: Form,
}

impl Implied {
    /// Leaves out of a text, from the line at `from` on, what rows of triangles it can.
    pub(super) fn take_lines_out(
        bytes: &mut Vec<u8>,
        from: usize,
        labels: Labels,
        triangles: &[[u32; 3]],
    ) -> Implied {
        let mut chunks = Vec::new();
        let mut start = from;
        while start < bytes.len() {
            let end = line_end(bytes, bytes.len().min(start + CHUNK - 1));
            chunks.push(start..end);
            start = end;
        }
        let next = |at| {
            let end = line_end(bytes, at);
            (end, Form::of_line(&bytes[at..end], labels, triangles))
        };
        let runs = chunks
            .into_par_iter()
            .flat_map_iter(|lines| runs(bytes, lines, labels, triangles, next))
            .collect();
        Self::take_runs_out(bytes, labels, runs)
    }

    /// Leaves out of a binary file what it can of these rows, which stand in the order of the file.
    pub(super) fn take_rows_out(
        bytes: &mut Vec<u8>,
        rows: &[Rows],
        order: Order,
        labels: Labels,
        triangles: &[[u32; 3]],
    ) -> Implied {
        let chunks = rows.iter().flat_map(|rows| {
            let Range { start, end } = rows.bytes;
            let size = (CHUNK / rows.size).max(1) * rows.size;
            (start..end).step_by(size).map(move |at| (rows, at..end.min(at + size)))
        });
        let chunks: Vec<_> = chunks.collect();
        let runs = chunks
            .into_par_iter()
            .flat_map_iter(|(rows, chunk)| {
                runs(bytes, chunk, labels, triangles, |at| {
                    let end = at + rows.size;
                    let t = rows.first + (at - rows.bytes.start) / rows.size;
                    (end, Form::of_row(&bytes[at..end], rows, order).map(|form| (t, form)))
                })
            })
            .collect();
        Self::take_runs_out(bytes, labels, runs)
    }

    fn take_runs_out(bytes: &mut Vec<u8>, labels: Labels, runs: Vec<Run>) -> Implied {
        let left_out: usize = runs.iter().map(|run| run.bytes.len()).sum();
        if left_out < bytes.len() / 8 {
            return Implied::default();
        }
        let mut kept = Vec::with_capacity(bytes.len() - left_out);
        let mut copied = 0;
        let mut gaps = Vec::with_capacity(runs.len());
        for Run { bytes: rows, triangles, form } in runs {
            kept.extend_from_slice(&bytes[copied..rows.start]);
            copied = rows.end;
            gaps.push(Gap { at: kept.len(), triangles, form });
        }
        kept.extend_from_slice(&bytes[copied..]);
        *bytes = kept;
        Implied { labels, gaps }
    }

    /// Writes the file from `start` in `bytes` on, of which rows were left out after that.
    pub(super) fn write(
        &self,
        out: &mut (dyn Write + Send),
        bytes: &[u8],
        start: usize,
        triangles: &[[u32; 3]],
    ) -> io::Result<()> {
        let mut written = start;
        for Gap { at, triangles: rows, form } in &self.gaps {
            out.write_all(&bytes[written..*at])?;
            written = *at;
            write_blocks(out, rows.len().div_ceil(BLOCK), |block| {
                let first = rows.start + block * BLOCK;
                let mut content = Vec::with_capacity(BLOCK * 40);
                let mut row = [0; 256];
                let listed = first..rows.end.min(first + BLOCK);
                for (t, &corners) in listed.clone().zip(&triangles[listed]) {
                    let length = form.put_row(&mut row, self.labels, t, corners);
                    content.extend_from_slice(&row[..length]);
                }
                content
            })?;
        }
        out.write_all(&bytes[written..])
    }

    /// The file as it was before rows were left out of it, if any were.
    pub(super) fn whole(&self, bytes: &[u8], triangles: &[[u32; 3]]) -> Option<Vec<u8>> {
        if self.gaps.is_empty() {
            return None;
        }
        let mut whole = Vec::new();
        self.write(&mut whole, bytes, 0, triangles).expect("memory takes what is written to it");
        Some(whole)
    }
}

/// The runs in some rows of a file that are worth it. Of the row at an offset, `next` tells where it ends, and the
/// triangle it seems to list and the form it has.
fn runs(
    bytes: &[u8],
    rows: Range<usize>,
    labels: Labels,
    triangles: &[[u32; 3]],
    next: impl Fn(usize) -> (usize, Option<(usize, Form)>),
) -> Vec<Run> {
    let bytes = &bytes[..rows.end];
    let mut runs: Vec<Run> = Vec::new();
    let mut row = [0; 256];
    let mut at = rows.start;
    while at < rows.end {
        // Its last run may yet be too short.
        if let Some(run) = runs.last_mut().filter(|run| run.bytes.end == at)
            && let Some(&corners) = triangles.get(run.triangles.end)
        {
            let length = run.form.put_row(&mut row, labels, run.triangles.end, corners);
            if bytes[at..].starts_with(&row[..length]) {
                at += length;
                run.bytes.end = at;
                run.triangles.end += 1;
                continue;
            }
        }
        if runs.last().is_some_and(|run| run.triangles.len() < WORTH) {
            runs.pop();
        }
        let (end, listed) = next(at);
        if let Some((t, form)) = listed {
            let length = form.put_row(&mut row, labels, t, triangles[t]);
            if bytes[at..end] == row[..length] {
                runs.push(Run { bytes: at..end, triangles: t..t + 1, form });
            }
        }
        at = end;
    }
    runs.retain(|run| run.triangles.len() >= WORTH);
    runs
}

struct Form {
    /// What stands in a row before the triangle's number, before each of its corners, and after them.
    between: [Box<[u8]>; 5],
    numbers: Numbers,
}

/// How numbers are written.
#[derive(Clone, Copy)]
enum Numbers {
    Digits,
    /// So many bytes.
    Bytes(usize, Order),
}

impl Form {
    /// The triangle that a line, its end included, seems to list, and the form it has.
    fn of_line(line: &[u8], labels: Labels, triangles: &[[u32; 3]]) -> Option<(usize, Form)> {
        let mut tokens = Vec::new();
        let mut at = skip_blanks(line, 0);
        while token_end(line, at) > at {
            tokens.push(at..token_end(line, at));
            at = skip_blanks(line, token_end(line, at));
        }
        let number = |token: &Range<usize>| integer(&line[token.clone()]);
        let t = number(tokens.first()?)?.checked_sub(labels.triangle)?;
        let t = usize::try_from(t).ok()?;
        let corners = triangles.get(t)?.map(|v| Some(labels.vertex + u64::from(v)));
        let mut triples = tokens[1..].windows(3);
        let [a, b, c] = triples.find(|triple| triple.iter().map(number).eq(corners))? else {
            return None;
        };
        let between = [
            0..tokens[0].start,
            tokens[0].end..a.start,
            a.end..b.start,
            b.end..c.start,
            c.end..line.len(),
        ];
        Some((t, Form::new(line, between, Numbers::Digits)?))
    }

    /// The form of a row of a binary file.
    fn of_row(row: &[u8], rows: &Rows, order: Order) -> Option<Form> {
        let width = rows.width;
        let corners = row.len() - 3 * width;
        let [b, c] = [corners + width, corners + 2 * width];
        let between =
            [0..rows.number_at, rows.number_at + width..corners, b..b, c..c, row.len()..row.len()];
        Form::new(row, between, Numbers::Bytes(width, order))
    }

    /// None if the row is longer than what is made again.
    fn new(row: &[u8], between: [Range<usize>; 5], numbers: Numbers) -> Option<Form> {
        let fits = between.iter().map(Range::len).sum::<usize>() <= LONGEST_BETWEEN;
        fits.then(|| Form { between: between.map(|part| row[part].into()), numbers })
    }

    /// Makes the row of a triangle. Returns its length.
    #[inline]
    fn put_row(&self, row: &mut Row, labels: Labels, t: usize, corners: [u32; 3]) -> usize {
        let [lead, before_a, before_b, before_c, end] = &self.between;
        let at = put(row, 0, lead);
        let mut at = self.numbers.put(row, at, labels.triangle.wrapping_add(t as u64));
        for (before, corner) in [before_a, before_b, before_c].into_iter().zip(corners) {
            at = put(row, at, before);
            at = self.numbers.put(row, at, labels.vertex + u64::from(corner));
        }
        put(row, at, end)
    }
}

impl Numbers {
    /// Puts a number there. Returns where it ends.
    #[inline]
    fn put(self, row: &mut Row, at: usize, number: u64) -> usize {
        match self {
            Numbers::Digits => put_number(row, at, number),
            Numbers::Bytes(width, Order::Little) => put(row, at, &number.to_le_bytes()[..width]),
            Numbers::Bytes(width, Order::Big) => put(row, at, &number.to_be_bytes()[8 - width..]),
        }
    }
}

/// Rows are made here; longer ones are kept. Four numbers have 80 digits at most, and eight are put at once.
type Row = [u8; 256];
const LONGEST_BETWEEN: usize = 256 - 88;

/// Mostly a single byte, not worth a call.
#[inline]
fn put(row: &mut Row, at: usize, text: &[u8]) -> usize {
    for (byte, &by) in row[at..].iter_mut().zip(text) {
        *byte = by;
    }
    at + text.len()
}

/// Puts the decimal digits of a number there. Returns where they end.
#[inline]
fn put_number(row: &mut Row, mut at: usize, number: u64) -> usize {
    const EIGHT: u64 = 100_000_000;
    if number >= EIGHT {
        at = put_number(row, at, number / EIGHT);
        row[at..at + 8].copy_from_slice(&eight_digits((number % EIGHT) as u32).to_le_bytes());
        return at + 8;
    }
    let number = number as u32;
    let length = number.checked_ilog10().map_or(1, |power| power as usize + 1);
    let digits = eight_digits(number) >> (8 * (8 - length));
    row[at..at + 8].copy_from_slice(&digits.to_le_bytes());
    at + length
}

/// The eight digits of a number below 10^8, the first one in the lowest byte.
#[inline]
fn eight_digits(number: u32) -> u64 {
    // Two lanes of four digits, four of two, eight of one. The products are quotients by 100 and 10 to below one.
    let fours = u64::from(number / 10_000) | (u64::from(number % 10_000) << 32);
    let hundreds = ((fours * 10_486) >> 20) & 0x7F_0000_007F;
    let twos = hundreds | ((fours - 100 * hundreds) << 16);
    let tens = ((twos * 103) >> 10) & 0x000F_000F_000F_000F;
    (tens | ((twos - 10 * tens) << 8)) + 0x3030_3030_3030_3030
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(count: u32) -> Vec<[u32; 3]> {
        (0..count).map(|t| [t * 7 % 1000, t, t * t % 4096]).collect()
    }

    /// Bytes kept of a text that must come back from them.
    fn kept(text: &str, labels: Labels, triangles: &[[u32; 3]]) -> usize {
        let mut bytes = text.as_bytes().to_vec();
        let implied = Implied::take_lines_out(&mut bytes, 0, labels, triangles);
        let whole = implied.whole(&bytes, triangles).unwrap_or_else(|| bytes.clone());
        assert!(whole == text.as_bytes(), "{text:.200}");
        bytes.len()
    }

    #[test]
    fn rows_left_out_come_back() {
        let count = 3 * BLOCK as u32 + 5;
        let triangles = triangles(count);
        let labels = Labels { triangle: 1, vertex: 10_000 };
        let text = |row: &dyn Fn(usize, [u64; 3]) -> String| {
            let rows = triangles.iter().enumerate();
            let rows = rows.map(|(t, corners)| row(t + 1, corners.map(|v| u64::from(v) + 10_000)));
            let rows: String = rows.collect();
            format!("# a comment\n{count} 3 0\r\n{rows}# and what follows\n1 2 3")
        };
        let plain = text(&|t, [a, b, c]| format!("{t} {a} {b} {c}\n"));
        assert!(kept(&plain, labels, &triangles) < 100);
        let gmsh = text(&|t, [a, b, c]| format!(" {t} 2 2 1 1 {a}\t{b} {c} \r\n"));
        assert!(kept(&gmsh, labels, &triangles) < 100);
        let attributes = text(&|t, [a, b, c]| format!("{t}  {a} {b} {c} {}\n", t / 5000));
        assert!(kept(&attributes, labels, &triangles) < 200);
        let comments = text(&|t, [a, b, c]| {
            let comment = if t % 500 == 3 { "\n# a comment\n" } else { "" };
            format!("{comment}{t} {a} {b} {c}\n")
        });
        assert!(kept(&comments, labels, &triangles) < comments.len() / 20);
        let long = text(&|t, [a, b, c]| format!("{t} {a} {b} {c} #{}\n", "-".repeat(200)));
        assert_eq!(kept(&long, labels, &triangles), long.len());
        let zeros = text(&|t, [a, b, c]| format!("{t} {a} {b} {}{c}\n", "0".repeat(t % 2)));
        assert_eq!(kept(&zeros, labels, &triangles), zeros.len());
        let plus = text(&|t, [a, b, c]| format!("{t} +{a} +{b} +{c}\n"));
        assert_eq!(kept(&plus, labels, &triangles), plus.len());
        let odd_first = plain.replacen("1 ", "01 ", 1);
        assert!(kept(&odd_first, labels, &triangles) < 200);
        let others = text(&|t, [a, b, c]| format!("{t} {a} {c} {b}\n"));
        assert_eq!(kept(&others, labels, &triangles), others.len());
        let twice = text(&|t, [a, b, c]| format!("{} {a} {b} {c}\n", t / 2 + 1));
        assert_eq!(kept(&twice, labels, &triangles), twice.len());
    }

    #[test]
    fn numbers_are_put_as_they_are_displayed() {
        let powers = (0..20).map(|power| 10_u64.pow(power));
        let around = powers.flat_map(|power| [power - 1, power, power + 1, power.wrapping_mul(7)]);
        let below = (0..100_000_000).step_by(4_999).chain(0..20_000);
        for number in around.chain(below).chain([u64::MAX]) {
            let mut row = [b'x'; 256];
            let end = put_number(&mut row, 3, number);
            assert_eq!(str::from_utf8(&row[..end]).unwrap(), format!("xxx{number}"));
        }
    }

    #[test]
    fn rows_of_numbers_left_out_come_back() {
        let triangles = triangles(3 * BLOCK as u32 + 5);
        let labels = Labels { triangle: 7, vertex: 1 };
        for order in [Order::Little, Order::Big] {
            // A header like that of version 2.2 before each row, and the rows of version 4.1.
            for (lead, width) in [(12, 4), (0, 8)] {
                let mut whole = b"$Elements\n".to_vec();
                let start = whole.len();
                for (t, corners) in triangles.iter().enumerate() {
                    whole.extend((0..lead).map(|i| i as u8 + 2));
                    let [a, b, c] = corners.map(|v| u64::from(v) + 1);
                    // Two are out of the order.
                    let tag = if t % 9000 == 8999 { 1 } else { t as u64 + 7 };
                    for number in [tag, a, b, c] {
                        match order {
                            Order::Little => whole.extend(&number.to_le_bytes()[..width]),
                            Order::Big => whole.extend(&number.to_be_bytes()[8 - width..]),
                        }
                    }
                }
                let size = lead + 4 * width;
                let bytes = start..whole.len();
                let rows = [Rows { bytes, first: 0, size, number_at: lead, width }];
                whole.extend(b"\n$EndElements");
                let mut kept = whole.clone();
                let implied = Implied::take_rows_out(&mut kept, &rows, order, labels, &triangles);
                assert_eq!(kept.len(), 10 + size + 13);
                assert!(implied.whole(&kept, &triangles).unwrap() == whole);
            }
        }
    }

    #[test]
    fn odd_texts_come_back() {
        let labels = Labels { triangle: u64::MAX, vertex: 0 };
        let triangles = triangles(40);
        for text in
            ["", "\n", "1", "18446744073709551615 0 0 0", "18446744073709551615 0 0 0\n1 7 1 1\n"]
        {
            assert_eq!(kept(text, labels, &triangles), text.len());
            assert_eq!(kept(text, labels, &[]), text.len());
        }
        let labels = Labels::default();
        for cut in 0..12 {
            let rows = triangles.iter().enumerate();
            let text: String = rows.map(|(t, [a, b, c])| format!("{t} {a} {b} {c}\n")).collect();
            let text = &text[..text.len() - cut];
            assert!(kept(text, labels, &triangles) < 30);
            assert!(kept(text, labels, &triangles[..35]) < 80);
        }
    }
}
