//! Cells of a net that lists edges and no faces.

use super::mesh::Mesh;
use super::planar::{Net, NetCells};
use super::table::Table;
use crate::content::remark::Remark;
use crate::error::ReadError;
use crate::text::cursor::CORRECT;
use crate::visit::items::{CellKind, Element};
use crate::visit::visitor::MeshVisitor;

/// Names of the link types of Delft3D FM's older nets, and the types of links that bound cells: 0 without a type, and 2.
/// Other links are one-dimensional.
const LINK_TYPES: &str = "NetLinkType";
const PLANE_LINKS: [i64; 2] = [0, 2];

/// The cells of a net, and the edges from which they were found.
pub(super) struct Cells<'h, 'a> {
    pub(super) edges: Table<'h, 'a>,
    found: NetCells,
}

impl<'h, 'a> Cells<'h, 'a> {
    /// Finds the cells of three to six edges.
    ///
    /// # Errors
    /// If an edge is damaged or has an unknown node, or if coordinates cannot be read.
    pub(super) fn find(mesh: &Mesh<'h, 'a>, edges: Table<'h, 'a>) -> Result<Self, ReadError> {
        let (mut nodes, mut ends) = (Vec::new(), Vec::with_capacity(edges.count));
        for edge in 0..edges.count {
            edges.nodes(edge, &mut nodes)?;
            let index = |node: u64| {
                let index = node.checked_sub(edges.first).filter(|&own| own < mesh.nodes as u64);
                index.map(|index| index as u32).ok_or_else(|| {
                    let id = edge as u64 + edges.first;
                    let problem =
                        format!("edge {id} has node {node}, which the list of nodes does not list");
                    edges.cursor(edge).error(problem, CORRECT)
                })
            };
            ends.push([index(nodes[0])?, index(nodes[1])?]);
        }
        let [x, y] = [mesh.x, mesh.y]
            .map(|axis| mesh.header.items(axis).map(|items| axis.numbers(items.own())));
        let points: Vec<[f64; 2]> = x?.into_iter().zip(y?).map(|(x, y)| [x, y]).collect();
        let types = mesh.header.variable(LINK_TYPES).filter(|_| mesh.is_of_links());
        let types = types.and_then(|types| mesh.header.integers(types)).unwrap_or_default();
        let is_side = |edge: usize| types.get(edge).is_none_or(|own| PLANE_LINKS.contains(own));
        let net = Net { points: &points, edges: &ends, is_in_degrees: mesh.is_in_degrees() };
        let found = net.cells(is_side);
        Ok(Cells { edges, found })
    }

    pub(super) fn count(&self) -> usize {
        self.found.ends.len()
    }

    /// Writes the ids of the nodes of a cell to `nodes`.
    pub(super) fn nodes(&self, cell: usize, nodes: &mut Vec<u64>) {
        let start = if cell == 0 { 0 } else { self.found.ends[cell - 1] };
        let own = &self.found.nodes[start..self.found.ends[cell]];
        nodes.clear();
        nodes.extend(own.iter().map(|&node| u64::from(node) + self.edges.first));
    }

    /// Returns the largest number of nodes of a cell.
    pub(super) fn corners(&self) -> usize {
        let last = self.count().checked_sub(2).map_or(0, |before| self.found.ends[before]);
        self.found.ends.last().map_or(0, |end| end - last)
    }

    /// Visits the edges at no cell as lines, and remarks on the cells.
    ///
    /// # Errors
    /// If the visitor refuses a line.
    pub(super) fn send_lines(&self, visitor: &mut dyn MeshVisitor) -> Result<(), ReadError> {
        let mut nodes = Vec::new();
        for &edge in &self.found.lines {
            let edge = edge as usize;
            self.edges.nodes(edge, &mut nodes)?;
            let id = edge as u64 + self.edges.first;
            let nodes = [nodes[0], nodes[1], 0, 0];
            let line = Element { id, kind: CellKind::Line, region: [0; 2], nodes };
            visitor.element(&self.edges.cursor(edge), &line)?;
        }
        if !self.found.lines.is_empty() {
            let count = self.found.lines.len() as u64;
            visitor.remark(Remark::elements(count, "edge", " at no cell"));
        }
        visitor.remark(Remark::CellsOfEdges { islands: self.found.cells_among_triangles() as u64 });
        Ok(())
    }
}
