//! The faces of a UGRID mesh: those of a connectivity table, or cells that were found from edges.

use super::cells::Cells;
use super::kind::TableKind;
use super::mesh::Mesh;
use super::table::Table;
use crate::binary::byte_order::IntegerType;
use crate::binary::number_field::NumberField;
use crate::error::ReadError;
use crate::netcdf::NumberType;
use crate::text::cursor::Cursor;
use crate::visit::items::{CellKind, Element};
use crate::visit::records::{Region, TriangleRecords};
use crate::visit::visitor::MeshVisitor;

/// The faces of a mesh.
pub(super) enum Faces<'h, 'a> {
    Listed(Table<'h, 'a>),
    Found(Cells<'h, 'a>),
}

impl<'h, 'a> Faces<'h, 'a> {
    /// Finds the faces of a mesh.
    ///
    /// # Errors
    /// If the connectivity table of faces or edges is unsuitable, or if an edge is damaged.
    pub(super) fn find(mesh: &Mesh<'h, 'a>) -> Result<Self, ReadError> {
        let (kind, variable) = mesh.connectivity;
        let table = Table::find(mesh, variable, kind)?;
        match kind {
            TableKind::Faces => Ok(Faces::Listed(table)),
            TableKind::Edges => Cells::find(mesh, table).map(Faces::Found),
        }
    }

    /// Returns the table of the file from which the faces are.
    pub(super) fn table(&self) -> &Table<'h, 'a> {
        match self {
            Faces::Listed(table) => table,
            Faces::Found(cells) => &cells.edges,
        }
    }

    /// Returns the table of faces; `None` for faces that were found from edges.
    pub(super) fn listed(&self) -> Option<&Table<'h, 'a>> {
        match self {
            Faces::Listed(table) => Some(table),
            Faces::Found(_) => None,
        }
    }

    pub(super) fn count(&self) -> usize {
        match self {
            Faces::Listed(table) => table.count,
            Faces::Found(cells) => cells.count(),
        }
    }

    /// Returns the largest number of corners that a face can have.
    pub(super) fn corners(&self) -> usize {
        match self {
            Faces::Listed(table) => table.corners,
            Faces::Found(cells) => cells.corners(),
        }
    }

    /// Reads the ids of the nodes of a face into `nodes`.
    ///
    /// # Errors
    /// If the entry of a table is damaged.
    pub(super) fn nodes(&self, face: usize, nodes: &mut Vec<u64>) -> Result<(), ReadError> {
        match self {
            Faces::Listed(table) => table.nodes(face, nodes),
            Faces::Found(cells) => {
                cells.nodes(face, nodes);
                Ok(())
            }
        }
    }

    /// Returns a cursor at the first entry of a face; at the list of edges for a face that was found from edges.
    fn cursor(&self, face: usize) -> Cursor<'a> {
        match self {
            Faces::Listed(table) => table.cursor(face),
            Faces::Found(cells) => cells.edges.cursor(0),
        }
    }

    /// Visits all faces, then the edges at no cell if faces were found from edges.
    ///
    /// # Errors
    /// If an entry of a table is damaged, or if the visitor refuses an element.
    pub(super) fn send(&self, visitor: &mut dyn MeshVisitor) -> Result<(), ReadError> {
        visitor.expect_elements(self.count());
        let taken = self.listed().map_or(0, |table| send_records(table, visitor));
        let mut nodes = Vec::with_capacity(self.corners());
        for face in taken..self.count() {
            self.nodes(face, &mut nodes)?;
            let cursor = &self.cursor(face);
            let (id, region) = (face as u64 + self.table().first, [0, 0]);
            let kind = match nodes.len() {
                3 => CellKind::Triangle,
                4 => CellKind::Quadrilateral,
                _ => {
                    visitor.polygon(cursor, id, region, &nodes)?;
                    continue;
                }
            };
            let mut own = [0; 4];
            own[..nodes.len()].copy_from_slice(&nodes);
            visitor.element(cursor, &Element { id, kind, region, nodes: own })?;
        }
        match self {
            Faces::Listed(_) => Ok(()),
            Faces::Found(cells) => cells.send_lines(visitor),
        }
    }
}

/// Visits faces in bulk if their table has 32- or 64-bit integers and a row of three corners per face. Returns the number
/// of visited faces.
fn send_records(faces: &Table<'_, '_>, visitor: &mut dyn MeshVisitor) -> usize {
    let (NumberType::Whole(IntegerType { bytes: width @ (4 | 8), .. }), 3, true) =
        (faces.variable.number, faces.corners, faces.has_rows)
    else {
        return 0;
    };
    visitor.triangle_records(&TriangleRecords {
        count: faces.count,
        nodes: NumberField::new(Some(faces.items.own()), 3 * width, width, faces.variable.order),
        min_node: 0,
        node_end: u64::MAX,
        regions: [Region::Same(0), Region::Same(0)],
        required_fields: &[],
    })
}
