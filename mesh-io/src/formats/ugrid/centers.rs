//! Places of faces and edges in a UGRID file, and of the corners of each.

use super::mesh::{Mesh, axis_of};
use super::table::{Table, TableKind};
use crate::formats::netcdf_points::{PointData, RecordParts};
use crate::netcdf::{NumberType, Variable};
use crate::visit::items::Centers;
use crate::visit::visitor::MeshVisitor;

/// The nodes of the faces of a mesh, and those of its edges if the file has edges.
pub(super) struct Tables<'h, 'a> {
    pub(super) faces: Table<'h, 'a>,
    edges: Option<Table<'h, 'a>>,
}

/// A variable with one coordinate of the centers of faces or edges.
pub(super) struct CenterVariable<'h> {
    pub(super) variable: &'h Variable,
    of: TableKind,
    /// x for 0, y for 1; others are not known.
    axis: usize,
    /// Whether it has a number for each corner, not for each face or edge.
    of_corners: bool,
}

impl<'h, 'a> Mesh<'h, 'a> {
    /// Adds the nodes of edges to those of faces.
    pub(super) fn tables(&self, faces: Table<'h, 'a>) -> Tables<'h, 'a> {
        let edges = self.named("edge_node_connectivity").into_iter().next();
        let edges = edges.and_then(|edges| Table::find(self, edges, TableKind::Edges).ok());
        Tables { faces, edges }
    }

    /// Finds the places of faces and edges: variables that the mesh names, and others as long that say that they are coordinates.
    pub(super) fn center_variables(&self, tables: &Tables<'h, 'a>) -> Vec<CenterVariable<'h>> {
        let mut found: Vec<CenterVariable<'h>> = Vec::new();
        for (of, attribute) in
            [(TableKind::Faces, "face_coordinates"), (TableKind::Edges, "edge_coordinates")]
        {
            for (place, variable) in self.named(attribute).into_iter().enumerate() {
                // What they say of themselves comes before their order. Third and further ones are other coordinates.
                let axis = if place < 2 { axis_of(variable).unwrap_or(place) } else { place };
                found.push(CenterVariable { variable, of, axis, of_corners: false });
            }
        }
        let counts = [Some(&tables.faces), tables.edges.as_ref()];
        let counts = counts.map(|table| table.map(|table| table.count as u64));
        for variable in &self.header.variables {
            let is_known = found.iter().any(|known| known.variable.name == variable.name);
            let (Some(axis), &[length], false) = (axis_of(variable), &variable.shape[..], is_known)
            else {
                continue;
            };
            let of = match counts.map(|count| count == Some(length)) {
                _ if length == self.nodes as u64 => continue,
                [true, false] => TableKind::Faces,
                [false, true] => TableKind::Edges,
                _ => continue,
            };
            found.push(CenterVariable { variable, of, axis, of_corners: false });
        }
        let bounds = |own: &CenterVariable<'h>| {
            let variable = self.variable(own.variable.text("bounds")?)?;
            Some(CenterVariable { variable, of_corners: true, ..*own })
        };
        let bounds: Vec<_> = found.iter().filter_map(bounds).collect();
        found.extend(bounds);
        found
    }

    /// Hands on the places of faces and edges. Returns the variables that are not handed on.
    pub(super) fn centers(
        &self,
        tables: &Tables<'h, 'a>,
        places: &[CenterVariable<'h>],
        points: &mut PointData<'h, 'a>,
        visitor: &mut dyn MeshVisitor,
    ) -> Vec<&'h Variable> {
        let left = places.iter().filter(|&place| {
            let table = match place.of {
                TableKind::Faces => Some(&tables.faces),
                TableKind::Edges => tables.edges.as_ref(),
            };
            let first = tables.faces.first;
            table.and_then(|table| send(table, first, place, points, visitor)).is_none()
        });
        left.map(|place| place.variable).collect()
    }
}

/// Hands on one coordinate of places, one for each element of a table or one for each of its corners. `None` if there are
/// not so many numbers. `first` is the id of the first node.
fn send<'h, 'a>(
    table: &Table<'h, 'a>,
    first: u64,
    &CenterVariable { variable, axis, of_corners, .. }: &CenterVariable<'h>,
    points: &mut PointData<'h, 'a>,
    visitor: &mut dyn MeshVisitor,
) -> Option<()> {
    let each = if of_corners { table.corners } else { 1 };
    let shape = [table.count as u64, each as u64];
    let shape = if of_corners { &shape[..] } else { &shape[..1] };
    let is_real = matches!(variable.number, NumberType::Real(_));
    if axis > 1 || variable.shape != shape || variable.is_record || !is_real {
        return None;
    }
    if !visitor.center_array(&variable.name, axis) {
        return Some(());
    }
    let (mut nodes, mut ends, mut of_one) = (Vec::new(), Vec::new(), Vec::new());
    for element in 0..table.count {
        table.nodes(element, &mut of_one).ok()?;
        let ids = of_one.iter().map(|node| (node + first).saturating_sub(table.first));
        if !of_corners {
            nodes.extend(ids);
            ends.push(nodes.len());
            continue;
        }
        let ids: Vec<u64> = ids.collect();
        for corner in 0..each {
            nodes.extend(ids.get(corner));
            ends.push(nodes.len());
        }
    }
    let numbers = points.numbers(variable, 0, 0, &RecordParts::WHOLE, variable.missing())?;
    visitor.center_numbers(Centers { nodes, ends, numbers });
    Some(())
}
