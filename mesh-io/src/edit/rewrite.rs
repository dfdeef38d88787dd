//! Rewrite of a file with some of its numbers replaced.

use crate::edit::column::{EditableColumn, NumberEdit};
use crate::edit::numbers::ByteEdit;
use crate::parallel::map_parts;
use std::io::{self, Write};
use std::ops::Range;

/// Bytes that one thread rewrites at a time.
const BLOCK_BYTES: usize = 1 << 17;

/// Content of a file, with numbers and byte ranges to be replaced.
pub(crate) struct Rewrite<'a> {
    /// The content as it was read.
    pub(crate) bytes: &'a [u8],
    /// Columns of numbers in the content. Changed numbers are replaced.
    pub(crate) columns: &'a [EditableColumn<'a>],
    /// Replacements of byte ranges, ascending and outside of all numbers of the columns.
    pub(crate) edits: &'a [ByteEdit],
}

impl Rewrite<'_> {
    /// Writes the content to `out`, with changed numbers and edits replaced.
    ///
    /// # Errors
    /// The errors of `out`, and [`io::ErrorKind::InvalidData`] if ranges to be replaced overlap: a damaged file, or one
    /// with several arrays of the same bytes. After an error, `out` has part of the content.
    pub(crate) fn write(&self, out: &mut (dyn Write + Send)) -> io::Result<()> {
        let mut at = 0;
        for edit in self.edits {
            if edit.range.start < at || edit.range.end > self.bytes.len() {
                return Err(overlap(edit.range.start));
            }
            self.write_range(at..edit.range.start, out)?;
            out.write_all(&edit.bytes)?;
            at = edit.range.end;
        }
        self.write_range(at..self.bytes.len(), out)
    }

    fn write_range(&self, range: Range<usize>, out: &mut (dyn Write + Send)) -> io::Result<()> {
        if self.columns.is_empty() {
            return out.write_all(&self.bytes[range]);
        }
        let count = range.len().div_ceil(BLOCK_BYTES);
        let cut = |block: usize| range.end.min(self.cut(range.start + block * BLOCK_BYTES));
        write_blocks(out, count, |block| {
            // The first block starts where the range starts, even within a number.
            let start = if block == 0 { range.start } else { cut(block) };
            self.block(start..cut(block + 1).max(start))
        })
    }

    /// Returns the first offset at or behind `at` outside of all numbers.
    fn cut(&self, mut at: usize) -> usize {
        loop {
            let before = at;
            for column in self.columns {
                let item = column.first_from(at);
                if let Some(last) = item.checked_sub(1) {
                    at = at.max(column.end(self.bytes, last));
                }
            }
            if at == before {
                return at;
            }
        }
    }

    /// Returns the rewritten content of a byte range.
    ///
    /// # Errors
    /// If changed numbers overlap or extend beyond the range.
    fn block(&self, range: Range<usize>) -> io::Result<Vec<u8>> {
        let mut changes = Vec::new();
        for column in self.columns {
            let items = column.first_from(range.start)..column.first_from(range.end);
            column.changes(self.bytes, items, &mut changes);
        }
        if self.columns.len() > 1 {
            // The changes of each column ascend already, which makes a stable sort fast.
            changes.sort_by_key(|change| change.range.start);
        }
        let mut out = Vec::with_capacity(range.len() + range.len() / 4);
        let mut copied = range.start;
        for NumberEdit { range, value, encoding, width } in changes {
            let between = self.bytes.get(copied..range.start);
            out.extend_from_slice(between.ok_or_else(|| overlap(range.start))?);
            let start = out.len();
            encoding.write(value, &mut out);
            let blanks = std::iter::repeat_n(b' ', (start + width).saturating_sub(out.len()));
            // If the field has no blank at its end, the old number is right-aligned, and so is the new number.
            let last = range.end.checked_sub(1).and_then(|last| self.bytes.get(last));
            let is_right = width > 0 && last.is_some_and(|&b| b > b' ');
            match is_right {
                true => drop(out.splice(start..start, blanks)),
                false => out.extend(blanks),
            }
            copied = range.end;
        }
        let rest = self.bytes.get(copied..range.end);
        out.extend_from_slice(rest.ok_or_else(|| overlap(copied))?);
        Ok(out)
    }
}

/// Makes the error of ranges that overlap at a byte offset.
#[cold]
fn overlap(at: usize) -> io::Error {
    let problem = format!("two numbers to be replaced overlap at byte {at} of the file as read");
    io::Error::new(io::ErrorKind::InvalidData, problem)
}

/// Writes the blocks of a file in order. While one thread writes finished blocks, other threads make the next blocks.
fn write_blocks(
    out: &mut (dyn Write + Send),
    count: usize,
    make: impl Fn(usize) -> io::Result<Vec<u8>> + Sync,
) -> io::Result<()> {
    let at_once = 2 * rayon::current_num_threads();
    let mut made: Vec<Vec<u8>> = Vec::new();
    for start in (0..count).step_by(at_once) {
        let next = start..count.min(start + at_once);
        let (written, next) = rayon::join(
            || made.iter().try_for_each(|block| out.write_all(block)),
            || map_parts(next, |_, block| make(block)),
        );
        written?;
        made = next.into_iter().collect::<io::Result<_>>()?;
    }
    made.iter().try_for_each(|block| out.write_all(block))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::binary::byte_order::ByteOrder;
    use crate::edit::numbers::{CoordinateEncoding, NumberEncoding, Offsets};
    use crate::precision::Precision;

    fn rewritten(bytes: &[u8], x_at: &[usize], old: &[[f64; 2]], new: &[[f64; 2]]) -> Vec<u8> {
        let places = Offsets::List(x_at.to_vec());
        let columns = EditableColumn::of_points(&places, None, CoordinateEncoding::TEXT, old, new);
        let mut out = Vec::new();
        Rewrite { bytes, columns: &columns, edits: &[] }.write(&mut out).unwrap();
        out
    }

    #[test]
    fn written_numbers_parse_back_to_the_same_bits() {
        let values = [
            -0.0,
            0.0,
            1e-7,
            1e16,
            -1.0 / 3.0,
            f64::MIN_POSITIVE,
            f64::from_bits(1),
            f64::MAX,
            123_456_789.123_456_79,
            1e15,
            0.1 + 0.2,
        ];
        for value in values {
            let out = rewritten(b"1 7 8 9", &[2], &[[7.0, 8.0]], &[[value, 8.0]]);
            let token = out[2..].split(|&b| b == b' ').next().unwrap();
            let token = str::from_utf8(token).unwrap().parse();
            assert_eq!(token.map(f64::to_bits), Ok(value.to_bits()));
            assert!(out.ends_with(b" 8 9"));
        }
    }

    /// The result must equal a plain replacement row by row. The rows fill several rounds of blocks.
    #[test]
    fn rewriting_in_blocks_equals_rewriting_row_by_row() {
        for vertices in [0, 1, 4000, 4001, 200_017] {
            let (mut bytes, mut expected) = (b"head\r\n".to_vec(), b"head\r\n".to_vec());
            let (mut x_at, mut old, mut new) = (Vec::new(), Vec::new(), Vec::new());
            let (mut z_at, mut z_old, mut z_new) = (Vec::new(), Vec::new(), Vec::new());
            for v in 0..vertices {
                let [x, y] = [v as f64 * 0.37, v as f64];
                let to = [x + f64::from(u8::from(v % 3 == 0)), if v % 5 == 0 { -y } else { y }];
                let end = if v % 7 == 0 { " # moved\r\n\n" } else { "\r\n" };
                write!(bytes, "{v}  ").unwrap();
                x_at.push(bytes.len());
                write!(bytes, "{x:?}\t{y:?} ").unwrap();
                z_at.push(bytes.len());
                write!(bytes, "7{end}").unwrap();
                let z = if v % 4 == 0 { 0.25 } else { 7.0 };
                let text = if v % 4 == 0 { "0.25" } else { "7" };
                write!(expected, "{v}  {:?}\t{:?} {text}{end}", to[0], to[1]).unwrap();
                old.push([x, y]);
                new.push(to);
                z_old.push(7.0);
                z_new.push(z);
            }
            bytes.extend_from_slice(b"tail 1 2 3");
            expected.extend_from_slice(b"tail 1 2 3");
            assert!(rewritten(&bytes, &x_at, &old, &old) == bytes, "{vertices} vertices");
            let x_at = Offsets::List(x_at);
            let mut columns =
                EditableColumn::of_points(&x_at, None, CoordinateEncoding::TEXT, &old, &new);
            let places = Offsets::List(z_at);
            let encoding = NumberEncoding::Text(Precision::Double);
            columns.push(EditableColumn::of_array(&places, encoding, &z_old, &z_new));
            let mut out = Vec::new();
            Rewrite { bytes: &bytes, columns: &columns, edits: &[] }.write(&mut out).unwrap();
            assert!(out == expected, "{vertices} vertices");
        }
    }

    /// Ranges that overlap or end behind the file are errors, whatever their order.
    #[test]
    fn ranges_that_overlap_are_errors() {
        let edit = |range: Range<usize>| ByteEdit { range, bytes: b"new".into() };
        let written = |edits: &[ByteEdit], starts: &[usize]| {
            let (old, new) = ([0.0], [1.0]);
            let encoding = NumberEncoding::Binary(ByteOrder::Big, Precision::Double);
            let places: Vec<Offsets> =
                starts.iter().map(|&start| Offsets::List(vec![start])).collect();
            let columns: Vec<_> = places
                .iter()
                .map(|places| EditableColumn::of_array(places, encoding, &old, &new))
                .collect();
            let mut out = Vec::new();
            Rewrite { bytes: &[0; 40], columns: &columns, edits }
                .write(&mut out)
                .map(|()| out.len())
        };
        assert_eq!(written(&[edit(2..5), edit(5..5)], &[8, 16]).unwrap(), 43);
        let overlapping: [(&[ByteEdit], &[usize]); 7] = [
            (&[edit(2..5), edit(2..5)], &[]),
            (&[edit(2..5), edit(4..6)], &[]),
            (&[edit(30..41)], &[]),
            (&[], &[8, 8]),
            (&[], &[8, 12]),
            (&[], &[36]),
            (&[edit(10..12)], &[8]),
        ];
        for (edits, starts) in overlapping {
            let error = written(edits, starts).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::InvalidData, "{starts:?}");
        }
    }

    /// Binary numbers of several arrays, interleaved and separate, beside ranges that are replaced.
    #[test]
    fn numbers_in_binary_are_replaced_where_they_stand() {
        let count = 40_000;
        let order = ByteOrder::Big;
        let row = |x: f64, y: f64, z: f32| {
            [&order.bytes(x)[..], &order.bytes(y), &order.single_bytes(z)].concat()
        };
        let old: Vec<[f64; 2]> = (0..count).map(|v| [f64::from(v), 0.5]).collect();
        let new: Vec<[f64; 2]> = old.iter().map(|[x, y]| [x * 3.0, y + 1.0]).collect();
        let z_old = vec![2.0; old.len()];
        let z_new: Vec<f64> = (0..count).map(|v| f64::from(v % 3)).collect();
        let rows: Vec<u8> = old.iter().flat_map(|[x, y]| row(*x, *y, 2.0)).collect();
        let bytes = [b"head", &rows[..], b"tail"].concat();
        let x_at = Offsets::Regular { start: 4, stride: 20 };
        let mut columns = EditableColumn::of_points(
            &x_at,
            None,
            CoordinateEncoding::adjacent(order, Precision::Double),
            &old,
            &new,
        );
        let places = Offsets::Regular { start: 20, stride: 20 };
        let encoding = NumberEncoding::Binary(order, Precision::Single);
        columns.push(EditableColumn::of_array(&places, encoding, &z_old, &z_new));
        let edits = [
            ByteEdit { range: 0..2, bytes: b"HHH".into() },
            ByteEdit { range: 3..4, bytes: vec![] },
        ];
        let mut out = Vec::new();
        Rewrite { bytes: &bytes, columns: &columns, edits: &edits }.write(&mut out).unwrap();
        let rows: Vec<u8> =
            new.iter().zip(&z_new).flat_map(|([x, y], z)| row(*x, *y, *z as f32)).collect();
        assert!(out == [b"HHHa", &rows[..], b"tail"].concat());
    }
}
