//! A row that lists a triangle, in text or in binary: how it is made from numbers.

use crate::file::binary::Order;
use crate::file::text::{integer, skip_blanks, token_end};
use std::ops::Range;

/// How triangles and vertices are numbered, if consecutively.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Labels {
    /// Number or tag of the first triangle.
    pub(crate) triangle: u64,
    /// Number or tag of the first vertex.
    pub(crate) vertex: u64,
}

/// Rows of a binary file, each of one triangle: its number, and at its end its corners.
#[derive(Clone, Debug)]
pub(crate) struct Rows {
    /// Where they stand.
    pub(crate) bytes: Range<usize>,
    /// The first triangle.
    pub(crate) first: usize,
    /// Bytes of a row.
    pub(crate) size: usize,
    /// Bytes before the triangle's number in a row.
    pub(crate) number_at: usize,
    /// Bytes of a number.
    pub(crate) width: usize,
}

/// What rows of triangles have in common.
pub(crate) struct Form {
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
    pub(crate) fn of_line(
        line: &[u8],
        labels: Labels,
        triangles: &[[u32; 3]],
    ) -> Option<(usize, Form)> {
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
    pub(crate) fn of_row(row: &[u8], rows: &Rows, order: Order) -> Option<Form> {
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
    pub(crate) fn put_row(
        &self,
        row: &mut Row,
        labels: Labels,
        t: usize,
        corners: [u32; 3],
    ) -> usize {
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

/// Rows are made in so many bytes; longer ones are not. Four numbers have 80 digits at most, and eight are put at once.
pub(crate) const LONGEST: usize = 256;
const LONGEST_BETWEEN: usize = LONGEST - 88;
type Row = [u8; LONGEST];

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

    #[test]
    fn numbers_are_put_as_they_are_displayed() {
        let powers = (0..20).map(|power| 10_u64.pow(power));
        let around = powers.flat_map(|power| [power - 1, power, power + 1, power.wrapping_mul(7)]);
        let below = (0..100_000_000).step_by(4_999).chain(0..20_000);
        for number in around.chain(below).chain([u64::MAX]) {
            let mut row = [b'x'; LONGEST];
            let end = put_number(&mut row, 3, number);
            assert_eq!(str::from_utf8(&row[..end]).unwrap(), format!("xxx{number}"));
        }
    }
}
