//! Rows of numbers in a written file, as text or in binary.

use crate::binary::byte_order::ByteOrder;
use std::io::Write;

/// Bytes of a file under construction. Numbers of a row are words in text, and have no separators in binary.
pub(crate) struct Rows {
    bytes: Vec<u8>,
    /// The byte order of binary numbers; `None` for text.
    order: Option<ByteOrder>,
    /// Whether the row has words.
    is_in_row: bool,
}

impl Rows {
    /// Starts a file. Numbers are in binary if a byte order is given.
    pub(crate) fn new(order: Option<ByteOrder>) -> Rows {
        Rows { bytes: Vec::new(), order, is_in_row: false }
    }

    pub(crate) fn order(&self) -> Option<ByteOrder> {
        self.order
    }

    /// Appends the bytes of other rows.
    pub(crate) fn append(&mut self, mut other: Rows) {
        self.bytes.append(&mut other.bytes);
    }

    /// Appends a word, in files of text.
    pub(crate) fn word(&mut self, word: &str) {
        self.text(word);
        self.is_in_row = true;
    }

    pub(crate) fn is_binary(&self) -> bool {
        self.order.is_some()
    }

    /// Returns the bytes of the file.
    pub(crate) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// Returns the file as text.
    pub(crate) fn into_text(self) -> String {
        String::from_utf8_lossy(&self.bytes).into_owned()
    }

    /// Appends text, in binary files too.
    pub(crate) fn text(&mut self, text: &str) {
        self.bytes.extend_from_slice(text.as_bytes());
    }

    /// Ends a row of text.
    pub(crate) fn end_row(&mut self) {
        if self.order.is_none() {
            self.bytes.push(b'\n');
        }
        self.is_in_row = false;
    }

    /// Ends a list: a list in binary is followed by a line end, which rows of text have already.
    pub(crate) fn end_list(&mut self) {
        if self.order.is_some() {
            self.bytes.push(b'\n');
        }
        self.is_in_row = false;
    }

    fn number<const N: usize>(&mut self, text: impl std::fmt::Display, mut big: [u8; N]) {
        match self.order {
            None => {
                let blank = if self.is_in_row { " " } else { "" };
                write!(self.bytes, "{blank}{text}").expect("memory can be written");
            }
            Some(ByteOrder::Big) => self.bytes.extend_from_slice(&big),
            Some(ByteOrder::Little) => {
                big.reverse();
                self.bytes.extend_from_slice(&big);
            }
        }
        self.is_in_row = true;
    }

    /// Appends a whole number, of one byte in binary.
    pub(crate) fn byte(&mut self, number: u8) {
        self.number(number, [number]);
    }

    /// Appends a whole number, of four bytes in binary.
    pub(crate) fn int(&mut self, number: i64) {
        self.number(number, (number as i32).to_be_bytes());
    }

    /// Appends a whole number, of eight bytes in binary.
    pub(crate) fn long(&mut self, number: i64) {
        self.number(number, number.to_be_bytes());
    }

    /// Appends a count, of eight bytes in binary.
    pub(crate) fn size(&mut self, number: u64) {
        self.number(number, number.to_be_bytes());
    }

    /// Appends a real number, of eight bytes in binary.
    pub(crate) fn real(&mut self, number: f64) {
        match number.is_nan() {
            true => self.number("nan", number.to_be_bytes()),
            false => self.number(format_args!("{number:?}"), number.to_be_bytes()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_words_or_bytes() {
        let fill = |rows: &mut Rows| {
            rows.int(-2);
            rows.real(0.5);
            rows.end_row();
            rows.byte(7);
            rows.size(258);
            rows.real(f64::NAN);
            rows.end_row();
            rows.end_list();
        };
        let mut text = Rows::new(None);
        fill(&mut text);
        assert_eq!(text.into_text(), "-2 0.5\n7 258 nan\n");
        let mut little = Rows::new(Some(ByteOrder::Little));
        fill(&mut little);
        let bytes = little.into_bytes();
        assert_eq!(bytes[..12], [254, 255, 255, 255, 0, 0, 0, 0, 0, 0, 224, 63]);
        assert_eq!((bytes.len(), &bytes[12..15], bytes[29]), (30, &[7, 2, 1][..], b'\n'));
        let mut big = Rows::new(Some(ByteOrder::Big));
        fill(&mut big);
        assert_eq!(big.into_bytes()[..4], [255, 255, 255, 254]);
    }
}
