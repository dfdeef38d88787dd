//! Rows of a file that the mesh itself tells: they are made again when they are written, rather than kept.
//!
//! The list of triangles is the larger half of a mesh's file, and its rows mostly differ in nothing but consecutive
//! numbers and the corners. A row is left out only if it was made again and found the same, byte for byte.

use crate::file::binary::Order;
use crate::file::rewrite::write_blocks;
use crate::file::row_form::{Form, LONGEST, Labels, Rows};
use crate::file::text::line_end;
use rayon::prelude::*;
use std::io::{self, Write};
use std::ops::Range;

/// How much of a file one thread looks through at a time.
const CHUNK: usize = 1 << 20;
/// Shorter runs of rows are kept as they are.
const WORTH: usize = 32;
/// How many rows one thread makes at a time.
const BLOCK: usize = 4096;

/// What was left out of a file.
#[derive(Default)]
pub(crate) struct Implied {
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
    pub(crate) fn take_lines_out(
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
    pub(crate) fn take_rows_out(
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
    pub(crate) fn write(
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
                let mut row = [0; LONGEST];
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
    pub(crate) fn whole(&self, bytes: &[u8], triangles: &[[u32; 3]]) -> Option<Vec<u8>> {
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
    let mut row = [0; LONGEST];
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
