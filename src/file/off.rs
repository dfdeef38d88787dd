//! Geomview's `.off`, as text: one row a vertex and one a face.
//!
//! The format: <http://www.geomview.org/docs/html/OFF.html>. Normals, colors and texture coordinates are not read.

use crate::error::ReadError;
use crate::file::format::Format;
use crate::file::heights::Heights;
use crate::file::numbers::Numbers;
use crate::file::sink::{Element, Kind, Layout, Sink, Walk, each_row, nodes};
use crate::file::source::Source;
use crate::file::text::{CUT_OFF, Cursor};
use crate::file::token::quoted;

pub(crate) struct Off;

impl Walk for Off {
    const VERTICES: &'static str = "the list of vertices";

    fn walk(source: &Source, sink: &mut dyn Sink) -> Result<Layout, ReadError> {
        let cursor = &mut Cursor::new(source);
        cursor.row(0, 1, "header lines")?;
        let header = cursor.token().unwrap_or_default();
        if !matches!(header, b"OFF" | b"COFF" | b"NOFF" | b"CNOFF" | b"STOFF" | b"STCNOFF") {
            let problem = format!("the header is `{}`, not OFF", quoted(header));
            return Err(cursor.error(problem, "Save as OFF with vertices of three coordinates"));
        }
        if header != b"OFF" {
            sink.leaves_out("normals, colors or texture coordinates");
        }
        if cursor.is_at(b'B') {
            return Err(cursor.error("binary OFF is not read", "Save as text"));
        }
        if !cursor.next_word() {
            return Err(cursor.error("the file ends before its counts", CUT_OFF));
        }
        let vertices = cursor.vertex_count()?;
        let faces = cursor.integer("the number of faces")?;
        sink.expect_nodes(cursor.capacity(vertices, "0 0 0\n".len()));
        let mut heights = Heights::new(sink);
        each_row(
            cursor,
            vertices,
            "vertices",
            sink,
            |cursor| {
                let point = cursor.point("a vertex")?;
                Ok((point, cursor.height("a vertex")?))
            },
            |cursor, sink, done, ((x_at, at), z)| {
                sink.node(cursor, done, 2, x_at, at);
                heights.see(z);
                Ok(())
            },
        )?;
        sink.end_nodes(cursor)?;
        heights.send("z", Numbers::TEXT.into(), sink);
        sink.expect_elements(cursor.capacity(faces, "3 0 1 2\n".len()));
        each_row(
            cursor,
            faces,
            "faces",
            sink,
            |cursor| {
                let corners = cursor.integer("the number of a face's vertices")?;
                let Some(kind) = Kind::of_polygon(corners) else {
                    let problem = format!("a face has {corners} vertices");
                    return Err(cursor.error(problem, "Split it into triangles"));
                };
                Ok((kind, nodes(cursor, kind)?))
            },
            |cursor, sink, tag, (kind, nodes)| {
                sink.element(cursor, &Element { tag, kind, region: [0; 2], nodes })
            },
        )?;
        Ok(Layout::in_place(Format::Off, Numbers::TEXT))
    }
}
