//! The header of a PLY file: the element lists, and the properties of each list.

use crate::binary::byte_order::ByteOrder;
use crate::edit::numbers::NumberEncoding;
use crate::error::ReadError;
use crate::precision::Precision;
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::row_layout::of_rows_or_words;
use crate::text::token::quoted;

/// The type of a property's numbers.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Number {
    Integer { size: usize, signed: bool },
    Float,
    Double,
}

/// A property of a list's items, such as `x` or `vertex_indices`.
pub(super) struct Property<'a> {
    pub(super) name: &'a [u8],
    /// The type of the length before the numbers of a list property; `None` for a property of one number.
    pub(super) length: Option<Number>,
    pub(super) number: Number,
}

pub(super) struct List<'a> {
    pub(super) name: &'a [u8],
    pub(super) count: u64,
    pub(super) properties: Vec<Property<'a>>,
}

/// The encoding of all items: text (`None`), or binary in a byte order.
#[derive(Clone, Copy)]
pub(super) struct Items {
    pub(super) order: Option<ByteOrder>,
}

/// Reads the header, and moves the cursor before the first item. Returns the encoding of items, and the element lists
/// in file order.
pub(super) fn header<'a>(cursor: &mut Cursor<'a>) -> Result<(Items, Vec<List<'a>>), ReadError> {
    cursor.line();
    let mut items = Items { order: None };
    let mut lists: Vec<List<'a>> = Vec::new();
    loop {
        cursor.row(0, 1, "lines of the header")?;
        match cursor.token().unwrap_or_default() {
            b"format" => {
                items.order = match cursor.token().unwrap_or_default() {
                    b"ascii" => None,
                    b"binary_little_endian" => Some(ByteOrder::Little),
                    b"binary_big_endian" => Some(ByteOrder::Big),
                    other => {
                        let problem = format!("the format is `{}`", quoted(other));
                        return Err(cursor.error(problem, CORRECT));
                    }
                }
            }
            b"element" => {
                let name = cursor.name().unwrap_or_default();
                let count = cursor.integer("the number of elements")?;
                lists.push(List { name, count, properties: Vec::new() });
            }
            b"property" => {
                let first = cursor.token().unwrap_or_default();
                let (length, number) = match first {
                    b"list" => (Some(number(cursor)?), number(cursor)?),
                    kind => (None, number_of(cursor, kind)?),
                };
                let name = cursor.name().unwrap_or_default();
                match lists.last_mut() {
                    Some(list) => list.properties.push(Property { name, length, number }),
                    None => {
                        return Err(
                            cursor.error("a property stands before the first element", CORRECT)
                        );
                    }
                }
            }
            b"end_header" => {
                if items.order.is_none() {
                    // Many programs read text word by word, so items need not start on a new line.
                    let listed = lists.iter().filter(|list| !list.properties.is_empty());
                    let count = listed.fold(0, |sum: u64, list| sum.saturating_add(list.count));
                    cursor.syntax = of_rows_or_words(cursor, cursor.source.bytes.len(), count);
                    cursor.rest();
                }
                return Ok((items, lists));
            }
            _ => {}
        }
    }
}

fn number(cursor: &mut Cursor<'_>) -> Result<Number, ReadError> {
    let kind = cursor.token().unwrap_or_default();
    number_of(cursor, kind)
}

fn number_of(cursor: &Cursor<'_>, kind: &[u8]) -> Result<Number, ReadError> {
    let integer = |size, signed| Ok(Number::Integer { size, signed });
    match kind {
        b"char" | b"int8" => integer(1, true),
        b"uchar" | b"uint8" => integer(1, false),
        b"short" | b"int16" => integer(2, true),
        b"ushort" | b"uint16" => integer(2, false),
        b"int" | b"int32" => integer(4, true),
        b"uint" | b"uint32" => integer(4, false),
        // meshio writes these types for numpy's arrays.
        b"int64" => integer(8, true),
        b"uint64" => integer(8, false),
        b"float" | b"float32" => Ok(Number::Float),
        b"double" | b"float64" => Ok(Number::Double),
        other => Err(cursor.error(format!("`{}` is not a type of PLY", quoted(other)), CORRECT)),
    }
}

impl Property<'_> {
    /// Returns the precision of the property's numbers, if it is a single real number.
    pub(super) fn precision(&self) -> Option<Precision> {
        match self.number {
            _ if self.length.is_some() => None,
            Number::Float => Some(Precision::Single),
            Number::Double => Some(Precision::Double),
            Number::Integer { .. } => None,
        }
    }
}

impl Number {
    pub(super) fn size(self) -> usize {
        match self {
            Number::Integer { size, .. } => size,
            Number::Float => 4,
            Number::Double => 8,
        }
    }
}

impl Items {
    /// Returns the encoding of the file's real numbers of a given precision.
    pub(super) fn form(self, precision: Precision) -> NumberEncoding {
        match self.order {
            None => NumberEncoding::Text(precision),
            Some(order) => NumberEncoding::Binary(order, precision),
        }
    }
}
