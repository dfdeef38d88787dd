//! Geomview's `.off`, as text.
//!
//! The format: <http://www.geomview.org/docs/html/OFF.html>. Vertices may be spread over lines in any way, but each
//! face starts on a new line. Normals, colors and texture coordinates are not read.

use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::format::Format;
use crate::text::cursor::{CUT_OFF, Cursor};
use crate::text::syntax::Syntax;
use crate::text::token::{integer, quoted};
use crate::visit::items::{CellKind, Element};
use crate::visit::reader::FormatReader;
use crate::visit::rows::{each_row, end_of_list, nodes};
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

pub(crate) struct Off;

/// Numbers behind the coordinates of a vertex, for users.
const OF_VERTICES: &str = "normals, colors or texture coordinates";

impl FormatReader for Off {
    const VERTICES: &'static str = "the list of vertices";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let cursor = &mut Cursor::new(source);
        cursor.row(0, 1, "header lines")?;
        // Geomview reads a file without a header as plain OFF.
        let has_header = integer(cursor.clone().token().unwrap_or_default()).is_none();
        let header = if has_header { cursor.token().unwrap_or_default() } else { b"OFF" };
        let more = match header {
            b"OFF" | b"off" => 0,
            b"NOFF" => 3,
            b"COFF" => 4,
            b"CNOFF" => 7,
            b"STOFF" => 2,
            b"STCNOFF" => 9,
            other => {
                let problem = format!("the header is `{}`, not OFF", quoted(other));
                return Err(cursor.error(problem, "Save as OFF with vertices of three coordinates"));
            }
        };
        if more > 0 {
            visitor.unsupported(OF_VERTICES);
        }
        if cursor.is_at(b'B') {
            return Err(cursor.error("binary OFF is not read", "Save as text"));
        }
        let vertices = count(cursor, "vertices")?;
        cursor.check_vertex_count(vertices)?;
        let is_spread = cursor.is_at_end();
        let faces = count(cursor, "faces")?;
        // Many files leave out the number of edges.
        match is_spread {
            true => _ = count(cursor, "edges")?,
            false => _ = cursor.token(),
        }
        let syntax = layout(cursor, vertices, faces, more);
        let more = if syntax.is_of_words() { more } else { 0 };
        *cursor = cursor.clone().with_syntax(syntax);
        visitor.expect_nodes(cursor.capacity(vertices, "0 0 0\n".len()));
        let mut z_values = ZValues::new(visitor);
        each_row(
            cursor,
            vertices,
            "vertices",
            visitor,
            |cursor| {
                let point = cursor.point("a vertex")?;
                let z = cursor.z("a vertex")?;
                for _ in 0..more {
                    cursor.real("a normal, color or texture coordinate of a vertex")?;
                }
                Ok((point, z, !cursor.syntax.is_of_words() && !cursor.is_at_end()))
            },
            |cursor, visitor, done, ((x_at, at), z, has_more)| {
                if has_more {
                    visitor.unsupported(OF_VERTICES);
                }
                visitor.node(cursor, done, 2, x_at, at);
                z_values.push(z);
                Ok(())
            },
        )?;
        visitor.end_nodes(cursor)?;
        z_values.send("z", CoordinateEncoding::TEXT.into(), visitor);
        visitor.expect_elements(cursor.capacity(faces, "3 0 1 2\n".len()));
        // A color may follow the corners of a face on its row.
        *cursor = cursor.clone().with_syntax(Syntax::RECORDS);
        let colored_face = |cursor: &mut Cursor<'_>| Ok((face(cursor)?, !cursor.is_at_end()));
        each_row(cursor, faces, "faces", visitor, colored_face, |cursor, visitor, id, read| {
            let ((kind, nodes), has_color) = read;
            if has_color {
                visitor.unsupported("colors of faces");
            }
            visitor.element(cursor, &Element { id, kind, region: [0; 2], nodes })
        })?;
        end_of_list(cursor, faces, "faces", face)?;
        Ok(CoordinateStorage::in_place(Format::Off, CoordinateEncoding::TEXT))
    }
}

/// Reads a face: its kind and its vertices.
fn face(cursor: &mut Cursor<'_>) -> Result<(CellKind, [u64; 4]), ReadError> {
    let corners = cursor.integer("the number of a face's vertices")?;
    let Some(kind) = CellKind::of_polygon(corners) else {
        let problem = format!("a face has {corners} vertices");
        return Err(cursor.error(problem, "Split it into triangles"));
    };
    Ok((kind, nodes(cursor, kind)?))
}

fn count(cursor: &mut Cursor<'_>, what: &str) -> Result<u64, ReadError> {
    if !cursor.next_word() {
        return Err(cursor.error("the file ends before its counts", CUT_OFF));
    }
    cursor.integer(format_args!("the number of {what}"))
}

/// Chooses the syntax of the vertices, which have `more` numbers besides coordinates. By default, each row has one
/// vertex, and further text in the row is ignored. If rows have too few numbers, or the file too few rows, vertices are
/// read word by word.
fn layout(cursor: &Cursor<'_>, vertices: u64, faces: u64, more: usize) -> Syntax {
    let starts_on_row = !cursor.is_at_end();
    let mut first = cursor.clone();
    if !starts_on_row && !first.next_row() {
        return Syntax::RECORDS;
    }
    let words = std::iter::from_fn(|| first.token()).take(3 + more).count();
    let is_of_words = words < 3 || !has_rows(cursor, vertices.saturating_add(faces));
    if is_of_words { Syntax::WORDS } else { Syntax::RECORDS }
}

/// Returns whether at least `count` rows follow.
fn has_rows(cursor: &Cursor<'_>, count: u64) -> bool {
    // Nearly all rows start with a digit or a minus sign, and such lines are counted faster than rows are read.
    let (bytes, start) = (&cursor.source.bytes, cursor.at());
    let is_row = |&at: &usize| matches!(bytes.get(start + at + 1), Some(b'0'..=b'9' | b'-'));
    let sure = memchr::memchr_iter(b'\n', &bytes[start..]).filter(is_row).count();
    let mut rows = cursor.clone();
    sure as u64 >= count || (0..count).all(|_| rows.next_row())
}
