//! Centers and corner coordinates of faces and edges in a UGRID file, which depend on the node coordinates.

use super::faces::Faces;
use super::kind::TableKind;
use super::mesh::{Mesh, axis_of};
use super::table::Table;
use crate::formats::netcdf_points::{PointData, RecordParts};
use crate::netcdf::{NumberType, Variable};
use crate::visit::items::Centers;
use crate::visit::visitor::MeshVisitor;

/// Connectivity of a mesh.
pub(super) struct Tables<'h, 'a> {
    pub(super) faces: Faces<'h, 'a>,
    /// Table of edges; `None` if the file has no edges or a damaged table.
    edges: Option<Table<'h, 'a>>,
}

/// A variable with one coordinate of the centers or corners of faces or edges.
pub(super) struct CenterVariable<'h> {
    pub(super) variable: &'h Variable,
    /// The elements that the variable describes.
    of: TableKind,
    /// Axis of the coordinate: 0 for x, 1 for y; other coordinates have a larger number.
    axis: usize,
    /// Whether the variable has a number per corner, not per element.
    of_corners: bool,
}

impl<'h, 'a> Mesh<'h, 'a> {
    /// Combines the faces with the table of edges, if the file has edges.
    pub(super) fn tables(&self, faces: Faces<'h, 'a>) -> Tables<'h, 'a> {
        let edges = self.named("edge_node_connectivity").into_iter().next();
        let edges = edges.and_then(|edges| Table::find(self, edges, TableKind::Edges).ok());
        Tables { faces, edges }
    }

    /// Finds the variables with coordinates of faces and edges. The mesh names some; others have an axis attribute and
    /// the length of faces or edges. The `bounds` variables of either kind have corner coordinates.
    pub(super) fn center_variables(&self, tables: &Tables<'h, 'a>) -> Vec<CenterVariable<'h>> {
        let mut found: Vec<CenterVariable<'h>> = Vec::new();
        for (of, attribute) in
            [(TableKind::Faces, "face_coordinates"), (TableKind::Edges, "edge_coordinates")]
        {
            for (place, variable) in self.named(attribute).into_iter().enumerate() {
                // The axis of the first two variables follows from their attributes, else from their order. Further
                // variables have neither x nor y.
                let axis = if place < 2 { axis_of(variable).unwrap_or(place) } else { place };
                found.push(CenterVariable { variable, of, axis, of_corners: false });
            }
        }
        let counts = [Some(tables.faces.count()), tables.edges.as_ref().map(|edges| edges.count)];
        let counts = counts.map(|count| count.map(|count| count as u64));
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

    /// Visits centers and corner coordinates of faces and edges. Returns the variables that do not fit the mesh, which
    /// a rewrite leaves unchanged.
    pub(super) fn centers(
        &self,
        tables: &Tables<'h, 'a>,
        places: &[CenterVariable<'h>],
        points: &mut PointData<'h, 'a>,
        visitor: &mut dyn MeshVisitor,
    ) -> Vec<&'h Variable> {
        let Tables { faces, edges } = tables;
        let first = faces.table().first;
        let left = places.iter().filter(|&place| {
            let sent = match (place.of, edges) {
                (TableKind::Faces, _) => {
                    let nodes = |face, nodes: &mut Vec<u64>| faces.nodes(face, nodes).ok();
                    let elements =
                        Elements { count: faces.count(), corners: faces.corners(), nodes };
                    elements.send(place, points, visitor)
                }
                (TableKind::Edges, Some(edges)) => {
                    // Edges may be numbered from another number than faces.
                    let nodes = |edge, nodes: &mut Vec<u64>| {
                        edges.nodes(edge, nodes).ok()?;
                        nodes
                            .iter_mut()
                            .for_each(|n| *n = (*n + first).saturating_sub(edges.first));
                        Some(())
                    };
                    let elements = Elements { count: edges.count, corners: edges.corners, nodes };
                    elements.send(place, points, visitor)
                }
                (TableKind::Edges, None) => None,
            };
            sent.is_none()
        });
        left.map(|place| place.variable).collect()
    }
}

/// The faces or the edges of a mesh. `nodes` writes the ids of the nodes of an element to a list, and returns `None` for a
/// damaged element.
struct Elements<N> {
    count: usize,
    /// The largest number of corners of an element.
    corners: usize,
    nodes: N,
}

impl<N: Fn(usize, &mut Vec<u64>) -> Option<()>> Elements<N> {
    /// Visits a variable with a number per element, or per corner. `None` if the variable is no list of real x or y
    /// coordinates of the right shape, or if an element is damaged.
    fn send<'h>(
        &self,
        &CenterVariable { variable, axis, of_corners, .. }: &CenterVariable<'h>,
        points: &mut PointData<'h, '_>,
        visitor: &mut dyn MeshVisitor,
    ) -> Option<()> {
        let each = if of_corners { self.corners } else { 1 };
        let shape = [self.count as u64, each as u64];
        let shape = if of_corners { &shape[..] } else { &shape[..1] };
        let is_real = matches!(variable.number, NumberType::Real(_));
        if axis > 1 || variable.shape != shape || variable.is_record || !is_real {
            return None;
        }
        if !visitor.center_array(&variable.name, axis) {
            return Some(());
        }
        let (mut nodes, mut ends, mut of_one) = (Vec::new(), Vec::new(), Vec::new());
        for element in 0..self.count {
            (self.nodes)(element, &mut of_one)?;
            if !of_corners {
                nodes.extend_from_slice(&of_one);
                ends.push(nodes.len());
                continue;
            }
            for corner in 0..each {
                nodes.extend(of_one.get(corner));
                ends.push(nodes.len());
            }
        }
        let numbers = points.numbers(variable, 0, 0, &RecordParts::WHOLE, variable.missing())?;
        visitor.center_numbers(Centers { nodes, ends, numbers });
        Some(())
    }
}
