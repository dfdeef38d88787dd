//! The grid of FVCOM, `CASE_grd.dat`.
//!
//! The format: "FVCOM User Manual", section on input files. Two rows have the numbers of nodes and cells; the cells and
//! then the nodes follow. FVCOM reads the grid by Fortran's list-directed input. The optional number after x and y is a
//! node's depth. Other files of a case repeat coordinates, and are not read.

use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::numbered_nodes::numbered_nodes;
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::syntax::Syntax;
use crate::text::token::{integer, key_value};
use crate::visit::items::{CellKind, Element};
use crate::visit::reader::FormatReader;
use crate::visit::rows::{each_row, nodes};
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;

pub(crate) struct Fvcom;

impl FormatReader for Fvcom {
    const VERTICES: &'static str = "the list of nodes";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let cursor = &mut Cursor::new(source).with_syntax(Syntax::FORTRAN);
        let count = number_of(cursor, "Node Number")?;
        cursor.check_vertex_count(count)?;
        let cells = number_of(cursor, "Cell Number")?;
        // Cells precede the nodes that they name, so cells are read twice: here only to find their end.
        let mut again = cursor.clone();
        each_row(cursor, cells, "cells", visitor, cell, |_, _, _, _| Ok(()))?;
        let depths = numbered_nodes(cursor, count, true, visitor)?;
        visitor.end_nodes(cursor)?;
        depths.send("depth", CoordinateEncoding::TEXT.into(), visitor);
        visitor.expect_elements(again.capacity(cells, "1 1 2 3\n".len()));
        each_row(&mut again, cells, "cells", visitor, cell, |cursor, visitor, _, cell| {
            visitor.element(cursor, &cell)
        })?;
        Ok(CoordinateStorage::in_place(Format::Fvcom, CoordinateEncoding::TEXT))
    }
}

/// Reads the next row, which must be `KEY = NUMBER`. The keyword may be in capital or small letters.
fn number_of(cursor: &mut Cursor<'_>, key: &str) -> Result<u64, ReadError> {
    cursor.row(0, 1, "lines of counts")?;
    let (before, after) = key_value(cursor.rest());
    // A comment may follow the number.
    let number = after.split(|byte| byte.is_ascii_whitespace() || *byte == b'!').next();
    let is_it = before.eq_ignore_ascii_case(key.as_bytes());
    match number.and_then(integer).filter(|_| is_it) {
        Some(count) => Ok(count),
        None => Err(cursor.error(format!("the row `{key} = ` with a number is missing"), CORRECT)),
    }
}

/// Reads a cell: its number and three nodes. Further numbers in the row are ignored.
#[inline]
fn cell(cursor: &mut Cursor<'_>) -> Result<Element, ReadError> {
    let id = cursor.integer("the number of a cell")?;
    let kind = CellKind::Triangle;
    Ok(Element { id, kind, region: [0; 2], nodes: nodes(cursor, kind)? })
}
