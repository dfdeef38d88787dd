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
        (kind, true) => match size_at(cursor, kind, count) {
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

/// Returns the width in bytes of the `count` binary numbers of type `kind` that follow; `None` for types that cannot be
/// read.
///
/// VTK writes numbers of the type `vtkIdType` in 4 bytes (`vtkDataWriter::WriteArray`), and reads them so. Other
/// programs write 8 bytes, as many as VTK has in memory. The width is 8 if an array of 8 bytes is followed by a keyword,
/// by the next array of a field or by the end of the file, and an array of 4 bytes by none of them.
pub(super) fn size_at(cursor: &Cursor<'_>, kind: &[u8], count: u64) -> Option<usize> {
    if !kind.eq_ignore_ascii_case(b"vtkidtype") {
        return size_of(kind);
    }
    let fits = |size: usize| {
        let length = usize::try_from(count).ok().and_then(|count| count.checked_mul(size));
        let end = length.and_then(|length| cursor.at_byte().checked_add(length));
        end.and_then(|end| cursor.bytes.get(end..)).is_some_and(may_follow)
    };
    Some(if !fits(4) && fits(8) { 8 } else { 4 })
}

/// Returns whether the bytes after an array start with a keyword or with the head of an array of a field, or are blank.
fn may_follow(bytes: &[u8]) -> bool {
    /// Keywords that stand after an array in a dataset or in its data.
    const KEYWORDS: [&[u8]; 23] = [
        b"METADATA",
        b"POINT_DATA",
        b"CELL_DATA",
        b"SCALARS",
        b"VECTORS",
        b"NORMALS",
        b"TENSORS",
        b"TENSORS6",
        b"GLOBAL_IDS",
        b"PEDIGREE_IDS",
        b"EDGE_FLAGS",
        b"TEXTURE_COORDINATES",
        b"COLOR_SCALARS",
        b"LOOKUP_TABLE",
        b"FIELD",
        b"POINTS",
        b"CELLS",
        b"POLYGONS",
        b"LINES",
        b"VERTICES",
        b"TRIANGLE_STRIPS",
        b"CELL_TYPES",
        b"CONNECTIVITY",
    ];
    let bytes = bytes.trim_ascii_start();
    let line = bytes.split(|&byte| byte == b'\n').next().unwrap_or_default();
    let Some(first) = words(line).next() else { return true };
    KEYWORDS.iter().any(|keyword| first.eq_ignore_ascii_case(keyword)) || is_array_head(line)
}

/// Returns whether a line has the name of an array, two counts and a type, as the head of an array of a field.
fn is_array_head(line: &[u8]) -> bool {
    let mut words = words(line).skip(1);
    let mut is_count = || words.next().is_some_and(|word| word.iter().all(u8::is_ascii_digit));
    is_count() && is_count() && words.next().is_some_and(|kind| kind.is_ascii())
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// Moves to the head of the next array of a field. Returns the name of the array, or `None` if the file ends. A line
/// that starts with a number sign is a comment only if it is no head, as names may start so too.
pub(super) fn array_name<'a>(cursor: &mut Cursor<'a>) -> Option<&'a [u8]> {
    loop {
        let start = cursor.at_byte();
        let line = cursor.line()?.trim_ascii_start();
        if !line.is_empty() && (!line.starts_with(b"#") || is_array_head(line)) {
            cursor.at = start;
            return cursor.name();
        }
    }
}

/// Returns the width in bytes of a binary number type; `None` for types that cannot be read, and for `vtkIdType`, whose
/// width [`size_at`] finds.
fn size_of(kind: &[u8]) -> Option<usize> {
    match kind.to_ascii_lowercase().as_slice() {
        // meshio writes the names that start with `vtktype` for whole numbers of all sizes.
        b"char" | b"unsigned_char" | b"signed_char" | b"vtktypeint8" | b"vtktypeuint8" => Some(1),
        b"short" | b"unsigned_short" | b"vtktypeint16" | b"vtktypeuint16" => Some(2),
        b"int" | b"unsigned_int" | b"float" | b"vtktypeint32" | b"vtktypeuint32" => Some(4),
        b"double" | b"long" | b"unsigned_long" | b"vtktypeint64" | b"vtktypeuint64" => Some(8),
        _ => None,
    }
}

/// Skips the METADATA behind an array of `components` numbers per tuple, if the next row starts METADATA. An empty line
/// ends them. The names of components before that line may be empty lines too.
pub(super) fn skip_metadata(cursor: &mut Cursor<'_>, components: u64) {
    let mut ahead = cursor.clone();
    while ahead.next_word()
        && ahead.token().is_some_and(|word| word.eq_ignore_ascii_case(b"METADATA"))
    {
        while let Some(line) = ahead.line().filter(|line| !line.is_empty()) {
            if line.eq_ignore_ascii_case(b"COMPONENT_NAMES") {
                (0..components).all(|_| ahead.line().is_some());
            }
        }
        *cursor = ahead.clone();
    }
}

/// Skips a FIELD of the dataset, after its keyword: name, array count and arrays.
pub(super) fn skip_field(cursor: &mut Cursor<'_>, binary: bool) -> Result<(), ReadError> {
    cursor.name();
    let arrays = cursor.integer("the number of arrays of a field")?;
    for done in 0..arrays {
        if array_name(cursor).is_none() {
            let problem = format!("the file ends after {done} of {arrays} arrays of a field");
            return Err(cursor.error(problem, CUT_OFF));
        }
        let components = cursor.integer("the number of components")?;
        let tuples = cursor.integer("the number of tuples")?;
        let kind = cursor.token().unwrap_or_default();
        skip_section(cursor, binary, kind, components.saturating_mul(tuples))?;
        skip_metadata(cursor, components);
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
