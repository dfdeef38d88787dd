//! Visits the faces of a UGRID mesh.

use super::table::Table;
use crate::binary::number_field::NumberField;
use crate::error::ReadError;
use crate::netcdf::NumberType;
use crate::visit::items::{CellKind, Element};
use crate::visit::records::{Region, TriangleRecords};
use crate::visit::visitor::MeshVisitor;

/// Visits all faces. A table of 32- or 64-bit integers with a row of three corners per face is visited in bulk.
pub(super) fn send(faces: &Table<'_, '_>, visitor: &mut dyn MeshVisitor) -> Result<(), ReadError> {
    visitor.expect_elements(faces.count);
    let mut taken = 0;
    if let (NumberType::Whole(width @ (4 | 8)), 3, true) =
        (faces.variable.number, faces.corners, faces.has_rows)
    {
        let own = faces.items.own();
        taken = visitor.triangle_records(&TriangleRecords {
            count: faces.count,
            nodes: NumberField::new(Some(own), 3 * width, width, faces.variable.order),
            min_node: 0,
            node_end: u64::MAX,
            regions: [Region::Same(0), Region::Same(0)],
            required_fields: &[],
        });
    }
    let mut nodes = Vec::with_capacity(faces.corners);
    for face in taken..faces.count {
        faces.nodes(face, &mut nodes)?;
        let cursor = &faces.cursor(face);
        let (id, region) = (face as u64 + faces.first, [0, 0]);
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
    Ok(())
}
