//! Tests of the cursor, and sources and cursors for other tests of text.

use super::*;

pub(crate) fn source(text: &[u8]) -> Source {
    Source {
        path: "m.txt".into(),
        bytes: text.to_vec(),
        compressed: None,
        options: crate::ReadOptions::new(),
        known: crate::disk::stamp::KnownState::default(),
        companions: Vec::new(),
        beside: None,
    }
}

/// Returns a cursor on the first row.
pub(crate) fn row_of(source: &Source) -> Cursor<'_> {
    let mut cursor = Cursor::new(source);
    cursor.next_row();
    cursor
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
