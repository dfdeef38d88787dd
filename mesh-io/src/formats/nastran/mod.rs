//! Bulk data of Nastran.
//!
//! The format: the Quick Reference Guides of MSC Nastran and Simcenter Nastran, on the format of bulk data entries, and
//! the User's Manual of NASTRAN-95. A card is one or more lines of fields, see [`card`]. Vertices of lines and
//! quadrilaterals, and nodes of masses, springs and rigid elements stay fixed. Each property is a region. Other cards,
//! such as materials, constraints and loads, are not read.

mod elements;
mod names;
mod nodes;
mod section;
mod types;

use crate::disk::source::Source;
use crate::error::ReadError;
use crate::format::Format;
use crate::text::card;
use crate::text::card::{CardLine, name_bytes};
use crate::text::cursor::Cursor;
use crate::text::syntax::Syntax;
use crate::text::token::integer;
use crate::visit::reader::FormatReader;
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use types::Class;

pub(crate) struct Nastran;

impl FormatReader for Nastran {
    const VERTICES: &'static str = "GRID";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let rows = section::rows(source);
        let numbers = nodes::send(&rows, visitor)?;
        elements::send(&rows, visitor)?;
        if visitor.asks_for_groups() {
            names::send(source, visitor);
        }
        Ok(CoordinateStorage::in_place(Format::Nastran, numbers))
    }
}

/// Maximum number of rows that are searched to recognize the format.
const MAX_DETECTION_ROWS: usize = 1000;

/// Returns whether the first [`MAX_DETECTION_ROWS`] rows have a statement that only Nastran uses (`BEGIN BULK`,
/// `CEND`), or a card of a node or an element.
pub(crate) fn is_nastran(source: &Source) -> bool {
    let mut cursor = Cursor::new(source).with_syntax(Syntax::CARDS);
    (0..MAX_DETECTION_ROWS).any(|_| cursor.next_row() && is_of_nastran(&cursor))
}

fn is_of_nastran(cursor: &Cursor<'_>) -> bool {
    let row = cursor.row_range();
    let line = &cursor.bytes[row.clone()];
    let name = CardLine::starting_at(cursor.bytes, row.start).name();
    let mut words = card::words(cursor.bytes, row);
    let mut next = || words.next().unwrap_or_default();
    match (name_bytes(&name), types::class(&name)) {
        (b"BEGIN", _) => section::is_begin(line),
        (b"CEND", _) => line.trim_ascii().len() == b"CEND".len(),
        (b"GRID", _) => {
            let is_numbered = integer(next()).is_some();
            let _system = next();
            let [x, y] = [next(), next()];
            let is_point = [x, y].iter().all(|word| nodes::number(word).is_some());
            is_numbered && is_point && !(x.is_empty() && y.is_empty())
        }
        (_, Some(Class::Of(_))) => {
            [next(), next(), next()].iter().all(|&word| integer(word).is_some())
        }
        _ => false,
    }
}
