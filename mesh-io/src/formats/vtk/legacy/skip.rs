//! Takes or skips the arrays of a legacy VTK file.

use crate::error::ReadError;
use crate::text::cursor::{CUT_OFF, Cursor};
use crate::text::token::quoted;

/// Skips an array of `count` numbers, bits or strings, whose type is `kind`.
pub(super) fn skip_section(
    cursor: &mut Cursor<'_>,
    binary: bool,
    kind: &[u8],
    count: u64,
) -> Result<(), ReadError> {
    let kind = kind.to_ascii_lowercase();
    match (kind.as_slice(), binary) {
        (b"string" | b"utf8_string", true) => strings(cursor, count),
        // Each string is a line, which may be empty.
        (b"string" | b"utf8_string", false) => each(cursor, count, |c| c.line().is_some()),
        (_, false) => each(cursor, count, |c| c.next_word() && c.token().is_some()),
        (b"bit", true) => take(cursor, count.div_ceil(8), 1).map(|_| ()),
        (kind, true) => match size_of(kind) {
            Some(size) => take(cursor, count, size).map(|_| ()),
            None => {
                let problem = format!("an array of the type `{}` is not read", quoted(kind));
                Err(cursor.error(problem, "Save without this array"))
            }
        },
    }
}

fn each<'a>(
    cursor: &mut Cursor<'a>,
    count: u64,
    mut passes: impl FnMut(&mut Cursor<'a>) -> bool,
) -> Result<(), ReadError> {
    match (0..count).all(|_| passes(cursor)) {
        true => Ok(()),
        false => Err(cursor.error("the file ends within an array", CUT_OFF)),
    }
}

/// Skips binary strings, each after its length. The two highest bits of a length give its width: 8, 4, 2 or 1 bytes for
/// 0, 1, 2 or 3.
fn strings(cursor: &mut Cursor<'_>, count: u64) -> Result<(), ReadError> {
    for _ in 0..count {
        let first = take(cursor, 1, 1)?[0];
        let more = [7, 3, 1, 0][usize::from(first >> 6)];
        let length = take(cursor, more, 1)?;
        let append = |length: u64, &byte: &u8| length << 8 | u64::from(byte);
        let length = length.iter().fold(u64::from(first & 0x3F), append);
        take(cursor, length, 1)?;
    }
    Ok(())
}

/// Returns the width in bytes of a binary number type; `None` for types that cannot be read.
pub(super) fn size_of(kind: &[u8]) -> Option<usize> {
    match kind.to_ascii_lowercase().as_slice() {
        // meshio writes the names that start with `vtktype` for whole numbers of all sizes.
        b"char" | b"unsigned_char" | b"signed_char" | b"vtktypeint8" | b"vtktypeuint8" => Some(1),
        b"short" | b"unsigned_short" | b"vtktypeint16" | b"vtktypeuint16" => Some(2),
        b"int" | b"unsigned_int" | b"float" | b"vtktypeint32" | b"vtktypeuint32" => Some(4),
        b"double" | b"long" | b"unsigned_long" | b"vtkidtype" | b"vtktypeint64"
        | b"vtktypeuint64" => Some(8),
        _ => None,
    }
}

/// Reads the name of the next array of a field, after any METADATA of the previous array. `None` if no name follows.
pub(super) fn array_name<'a>(cursor: &mut Cursor<'a>) -> Option<&'a [u8]> {
    loop {
        let name = cursor.token()?;
        if !name.eq_ignore_ascii_case(b"METADATA") {
            return Some(name);
        }
        while cursor.line().is_some_and(|line| !line.is_empty()) {}
        cursor.next_row().then_some(())?;
    }
}

/// Skips a FIELD of the dataset, after its keyword: name, array count and arrays.
pub(super) fn skip_field(cursor: &mut Cursor<'_>, binary: bool) -> Result<(), ReadError> {
    cursor.token();
    let arrays = cursor.integer("the number of arrays of a field")?;
    for done in 0..arrays {
        cursor.row(done, arrays, "arrays of a field")?;
        if array_name(cursor).is_none() {
            return Err(cursor.error("the file ends within a field", CUT_OFF));
        }
        let components = cursor.integer("the number of components")?;
        let tuples = cursor.integer("the number of tuples")?;
        let kind = cursor.token().unwrap_or_default();
        skip_section(cursor, binary, kind, components.saturating_mul(tuples))?;
    }
    Ok(())
}

/// Takes `count` binary items of `size` bytes, which start on the next line, or after the bytes taken last. All words
/// of the cursor's line must have been read.
pub(super) fn take<'a>(
    cursor: &mut Cursor<'a>,
    count: u64,
    size: usize,
) -> Result<&'a [u8], ReadError> {
    let bytes = usize::try_from(count).ok().and_then(|count| count.checked_mul(size));
    let problem = format!("the file ends before {count} items of {size} bytes");
    match bytes {
        None => Err(cursor.error(problem, CUT_OFF)),
        Some(bytes) => {
            let start = cursor.clone();
            cursor.take(bytes).ok_or_else(|| start.error(problem, CUT_OFF))
        }
    }
}
