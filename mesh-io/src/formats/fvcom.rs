//! The grid of FVCOM, `CASE_grd.dat`.
//!
//! The format: "FVCOM User Manual", section on input files. Two rows tell the numbers of nodes and of cells; then come the
//! cells and the nodes. The program reads them as Fortran reads lists. The third number of a node's row, if there is one,
//! is its depth. Other files of a case repeat coordinates; they are not read.

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
        // Cells stand before the nodes that they name, so they are read twice.
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

/// Reads the next row, which must be `KEY = NUMBER`.
fn number_of(cursor: &mut Cursor<'_>, key: &str) -> Result<u64, ReadError> {
    cursor.row(0, 1, "lines of counts")?;
    let (before, after) = key_value(cursor.rest());
    // A comment may follow.
    let number = after.split(|byte| byte.is_ascii_whitespace() || *byte == b'!').next();
    let is_it = before.eq_ignore_ascii_case(key.as_bytes());
    match number.and_then(integer).filter(|_| is_it) {
        Some(count) => Ok(count),
        None => Err(cursor.error(format!("the row `{key} = ` with a number is missing"), CORRECT)),
    }
}

/// Reads a cell. What stands behind its nodes is not used.
#[inline]
fn cell(cursor: &mut Cursor<'_>) -> Result<Element, ReadError> {
    let id = cursor.integer("the number of a cell")?;
    let kind = CellKind::Triangle;
    Ok(Element { id, kind, region: [0; 2], nodes: nodes(cursor, kind)? })
}
