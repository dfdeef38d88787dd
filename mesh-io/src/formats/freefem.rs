//! FreeFem's `.msh`, a mesh of the plane.
//!
//! The format: <https://doc.freefem.org/documentation/mesh-generation.html>, "Data Structures and Read/Write Statements
//! for a Mesh". Vertices are numbered from 1.

use crate::content::group_label::GroupLabel;
use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::format::Format;
use crate::text::cursor::Cursor;
use crate::text::syntax::Syntax;
use crate::visit::items::{CellKind, Element, RegionAttribute};
use crate::visit::reader::FormatReader;
use crate::visit::rows::{each_row, end_of_list, nodes};
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;

pub(crate) struct FreeFem;

impl FormatReader for FreeFem {
    const VERTICES: &'static str = "the list of vertices";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let cursor = &mut Cursor::new(source).with_syntax(Syntax::WORDS);
        cursor.row(0, 1, "lines of counts")?;
        let vertices = cursor.vertex_count()?;
        let triangles = cursor.integer("the number of triangles")?;
        let edges = cursor.integer("the number of edges")?;
        visitor.expect_nodes(cursor.capacity(vertices, "0 0 0\n".len()));
        let before = &mut cursor.clone();
        each_row(
            cursor,
            vertices,
            "vertices",
            visitor,
            |cursor| {
                let point = cursor.point("a vertex")?;
                cursor.signed("the label of a vertex")?;
                Ok(point)
            },
            |cursor, visitor, done, (x_at, at)| {
                visitor.node(cursor, done + 1, 2, x_at, at);
                Ok(())
            },
        )?;
        if visitor.asks_for_groups() {
            for vertex in 0..vertices {
                before.row(vertex, vertices, "vertices")?;
                let label = |cursor: &mut Cursor<'_>| {
                    cursor.point("a vertex")?;
                    cursor.signed("the label of a vertex")
                };
                let label = before.item(label, &mut None)?;
                // A vertex without a label has the label 0.
                if label != 0 {
                    visitor.node_group(vertex as u32, "label", &GroupLabel::Tag(label));
                }
            }
        }
        visitor.end_nodes(cursor)?;
        visitor.region_attributes(vec![RegionAttribute::tags("label", 1)]);
        visitor.expect_elements(cursor.capacity(triangles, "1 2 3 0\n".len()));
        for (kind, count, what) in
            [(CellKind::Triangle, triangles, "triangles"), (CellKind::Line, edges, "edges")]
        {
            each_row(
                cursor,
                count,
                what,
                visitor,
                |cursor| Ok((nodes(cursor, kind)?, cursor.signed("a label")?)),
                |cursor, visitor, done, (nodes, label)| {
                    let element = Element { id: done + 1, kind, region: [label, 0], nodes };
                    visitor.element(cursor, &element)
                },
            )?;
        }
        end_of_list(cursor, edges, "edges", |cursor| cursor.signed("a number"))?;
        Ok(CoordinateStorage::in_place(Format::FreeFem, CoordinateEncoding::TEXT))
    }
}
