//! FreeFem's `.msh`, a mesh of the plane.
//!
//! The format: <https://doc.freefem.org/documentation/mesh-generation.html>, "Data Structures and Read/Write Statements
//! for a Mesh". All numbers start at one.

use crate::content::label::Label;
use crate::disk::source::Source;
use crate::edit::numbers::Numbers;
use crate::error::ReadError;
use crate::format::Format;
use crate::text::cursor::Cursor;
use crate::text::syntax::Syntax;
use crate::visit::items::{Column, Element, Kind};
use crate::visit::reader::Walk;
use crate::visit::rows::{each_row, nodes};
use crate::visit::sink::Sink;
use crate::visit::storage::Layout;

pub(crate) struct FreeFem;

impl Walk for FreeFem {
    const VERTICES: &'static str = "the list of vertices";

    fn walk(source: &Source, sink: &mut dyn Sink) -> Result<Layout, ReadError> {
        let cursor = &mut Cursor::new(source).of(Syntax::WORDS);
        cursor.row(0, 1, "lines of counts")?;
        let vertices = cursor.vertex_count()?;
        let triangles = cursor.integer("the number of triangles")?;
        let edges = cursor.integer("the number of edges")?;
        sink.expect_nodes(cursor.capacity(vertices, "0 0 0\n".len()));
        let before = &mut cursor.clone();
        each_row(
            cursor,
            vertices,
            "vertices",
            sink,
            |cursor| {
                let point = cursor.point("a vertex")?;
                cursor.signed("the label of a vertex")?;
                Ok(point)
            },
            |cursor, sink, done, (x_at, at)| {
                sink.node(cursor, done + 1, 2, x_at, at);
                Ok(())
            },
        )?;
        if sink.asks_for_groups() {
            for vertex in 0..vertices {
                before.row(vertex, vertices, "vertices")?;
                let label = |cursor: &mut Cursor<'_>| {
                    cursor.point("a vertex")?;
                    cursor.signed("the label of a vertex")
                };
                let label = before.item(label, &mut None)?;
                // A vertex without a label has the label 0.
                if label != 0 {
                    sink.node_within(vertex as u32, "label", &Label::Tag(label));
                }
            }
        }
        sink.end_nodes(cursor)?;
        sink.columns(vec![Column::tags("label", 1)]);
        sink.expect_elements(cursor.capacity(triangles, "1 2 3 0\n".len()));
        for (kind, count, what) in
            [(Kind::Triangle, triangles, "triangles"), (Kind::Line, edges, "edges")]
        {
            each_row(
                cursor,
                count,
                what,
                sink,
                |cursor| Ok((nodes(cursor, kind)?, cursor.signed("a label")?)),
                |cursor, sink, done, (nodes, label)| {
                    let element = Element { tag: done + 1, kind, region: [label, 0], nodes };
                    sink.element(cursor, &element)
                },
            )?;
        }
        Ok(Layout::in_place(Format::FreeFem, Numbers::TEXT))
    }
}
