//! Writes a file again with the coordinates of moved vertices replaced.

use crate::file::binary::Order;
use crate::file::numbers::{Encoded, Numbers};
use crate::file::text::{skip_to_token, token_end};
use crate::mesh::Precision;
use crate::parallel::map_parts;
use std::io::{self, Write};
use std::ops::Range;

/// How many vertices one thread rewrites at a time.
const BLOCK: usize = 2048;

/// A file's content, and which of its coordinates are to be replaced.
pub(crate) struct Rewrite<'a> {
    /// The content as it was read.
    pub(crate) bytes: &'a [u8],
    /// Where each vertex's x starts, ascending. Empty for a file without vertices.
    pub(crate) x_at: &'a [usize],
    /// How the coordinates stand there.
    pub(crate) numbers: Numbers,
    /// The coordinates as they were read.
    pub(crate) old: &'a [[f64; 2]],
    /// The coordinates to be written.
    pub(crate) new: &'a [[f64; 2]],
}

impl Rewrite<'_> {
    /// Writes the content to `out`, with those coordinates replaced whose bits differ between `old` and `new`.
    pub(crate) fn write(&self, out: &mut (dyn Write + Send)) -> io::Result<()> {
        let vertices = self.x_at.len();
        if let Numbers::Binary { order, precision, y_after } = self.numbers
            && y_after != precision.bytes()
            && vertices > 0
        {
            return out.write_all(&self.in_two_lists(order, precision, y_after));
        }
        write_blocks(out, vertices.div_ceil(BLOCK), |block| {
            self.block(block * BLOCK..vertices.min((block + 1) * BLOCK))
        })?;
        out.write_all(&self.bytes[self.start_of(vertices)..])
    }

    /// Writes `file` to `out`, with the content of this rewrite encoded in it where that changed.
    pub(crate) fn write_encoded(
        &self,
        file: &[u8],
        encoded: &dyn Encoded,
        out: &mut (dyn Write + Send),
    ) -> io::Result<()> {
        let mut new = Vec::with_capacity(self.bytes.len());
        self.write(&mut new)?;
        let mut copied = 0;
        if new != self.bytes {
            for splice in encoded.splices(&new) {
                out.write_all(&file[copied..splice.range.start])?;
                out.write_all(&splice.bytes)?;
                copied = splice.range.end;
            }
        }
        out.write_all(&file[copied..])
    }

    /// The new content of some vertices, up to the first vertex after them.
    fn block(&self, vertices: Range<usize>) -> Vec<u8> {
        match self.numbers {
            Numbers::Text { precision } => self.block_of_text(precision, vertices),
            Numbers::Binary { order, precision, .. } => {
                self.block_of_numbers(order, precision, vertices)
            }
        }
    }

    fn block_of_numbers(
        &self,
        order: Order,
        precision: Precision,
        vertices: Range<usize>,
    ) -> Vec<u8> {
        let start = self.start_of(vertices.start);
        let mut out = self.bytes[start..self.start_of(vertices.end)].to_vec();
        for v in vertices {
            let x_at = self.x_at[v] - start;
            for (axis, (old, new)) in self.old[v].iter().zip(self.new[v]).enumerate() {
                put(&mut out, x_at + axis * precision.bytes(), order, precision, *old, new);
            }
        }
        out
    }

    /// The new content of a file that lists y elsewhere than x.
    fn in_two_lists(&self, order: Order, precision: Precision, y_after: usize) -> Vec<u8> {
        let mut out = self.bytes.to_vec();
        for ((&x_at, old), new) in self.x_at.iter().zip(self.old).zip(self.new) {
            put(&mut out, x_at, order, precision, old[0], new[0]);
            put(&mut out, x_at + y_after, order, precision, old[1], new[1]);
        }
        out
    }

    fn block_of_text(&self, precision: Precision, vertices: Range<usize>) -> Vec<u8> {
        let Rewrite { bytes, x_at, old, new, .. } = self;
        let mut copied = self.start_of(vertices.start);
        let end_of_block = self.start_of(vertices.end);
        let mut out = Vec::with_capacity((end_of_block - copied) * 5 / 4);
        for v in vertices {
            let mut start = x_at[v];
            for (old, new) in old[v].iter().zip(new[v]) {
                start = skip_to_token(bytes, start);
                let end = token_end(bytes, start);
                let new = precision.rounded(new);
                if old.to_bits() != new.to_bits() {
                    out.extend_from_slice(&bytes[copied..start]);
                    // The fewest digits that parse back to the same bits.
                    match precision {
                        Precision::Double => write!(out, "{new:?}"),
                        Precision::Single => write!(out, "{:?}", new as f32),
                    }
                    .expect("memory takes what is written to it");
                    copied = end;
                }
                start = end;
            }
        }
        out.extend_from_slice(&bytes[copied..end_of_block]);
        out
    }

    /// Where the content of a vertex starts: the first vertex's at the start of the file, any other's at its x. For the
    /// number of vertices, where the last vertex's coordinates end.
    fn start_of(&self, vertex: usize) -> usize {
        match vertex.checked_sub(1) {
            None => 0,
            Some(before) if vertex == self.x_at.len() => {
                if let Numbers::Binary { precision, .. } = self.numbers {
                    return self.x_at[before] + 2 * precision.bytes();
                }
                let y_at = skip_to_token(self.bytes, token_end(self.bytes, self.x_at[before]));
                token_end(self.bytes, y_at)
            }
            Some(_) => self.x_at[vertex],
        }
    }
}

/// Replaces a number in binary if it moved.
#[inline]
fn put(out: &mut [u8], at: usize, order: Order, precision: Precision, old: f64, new: f64) {
    let new = precision.rounded(new);
    if old.to_bits() != new.to_bits() {
        match precision {
            Precision::Single => {
                out[at..][..4].copy_from_slice(&order.single_bytes(new as f32));
            }
            Precision::Double => out[at..][..8].copy_from_slice(&order.bytes(new)),
        }
    }
}

/// Writes blocks of a file in their order. While one thread writes some of them, the others make the next.
fn write_blocks(
    out: &mut (dyn Write + Send),
    count: usize,
    make: impl Fn(usize) -> Vec<u8> + Sync,
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
        made = next;
    }
    made.iter().try_for_each(|block| out.write_all(block))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rewritten(bytes: &[u8], x_at: &[usize], old: &[[f64; 2]], new: &[[f64; 2]]) -> Vec<u8> {
        let mut out = Vec::new();
        Rewrite { bytes, x_at, numbers: Numbers::TEXT, old, new }.write(&mut out).unwrap();
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

    /// Against a plain replacement, row by row, of as many rows as fill several waves of blocks.
    #[test]
    fn blocks_join_without_a_seam() {
        for vertices in [0, 1, BLOCK - 1, BLOCK, BLOCK + 1, 70 * BLOCK + 17] {
            let (mut bytes, mut expected) = (b"head\r\n".to_vec(), b"head\r\n".to_vec());
            let (mut x_at, mut old, mut new) = (Vec::new(), Vec::new(), Vec::new());
            for v in 0..vertices {
                let [x, y] = [v as f64 * 0.37, v as f64];
                let to = [x + f64::from(u8::from(v % 3 == 0)), if v % 5 == 0 { -y } else { y }];
                let end = if v % 7 == 0 { " # moved\r\n\n" } else { "\r\n" };
                write!(bytes, "{v}  ").unwrap();
                x_at.push(bytes.len());
                write!(bytes, "{x:?}\t{y:?}{end}").unwrap();
                write!(expected, "{v}  {:?}\t{:?}{end}", to[0], to[1]).unwrap();
                old.push([x, y]);
                new.push(to);
            }
            bytes.extend_from_slice(b"tail 1 2 3");
            expected.extend_from_slice(b"tail 1 2 3");
            assert!(rewritten(&bytes, &x_at, &old, &new) == expected, "{vertices} vertices");
            assert!(rewritten(&bytes, &x_at, &old, &old) == bytes, "{vertices} vertices");
        }
    }
}
