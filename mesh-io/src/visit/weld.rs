//! Joins nodes at one position to a vertex, between a reader and a visitor.

use crate::content::group_label::GroupLabel;
use crate::content::remark::Remark;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::items::{CellKind, Element, GroupScope, PointNumbers, RegionAttribute};
use crate::visit::storage::RepeatedVertices;
use crate::visit::visitor::MeshVisitor;
use std::collections::HashMap;

/// Visitor of the nodes of a file, which collects positions. Node ids must count from 0 in file order.
#[derive(Default)]
pub(crate) struct NodePositions {
    points: Vec<[f64; 2]>,
    /// The offset of each node's x.
    x_at: Vec<usize>,
    z_values: Vec<f64>,
}

impl NodePositions {
    /// Returns for each node the id of the first node at the same position. `None` if no two nodes have one position.
    /// Positions are equal to the last bit, except for the sign of zero.
    fn first_nodes(&self) -> Option<Vec<u64>> {
        let mut first: HashMap<[u64; 3], u64> = HashMap::with_capacity(self.points.len());
        // Adding zero makes a negative zero positive.
        let place = |node: usize, [x, y]: [f64; 2]| {
            let z = self.z_values.get(node).copied().unwrap_or(0.0);
            [x, y, z].map(|x| (x + 0.0).to_bits())
        };
        let nodes = self.points.iter().enumerate();
        let first_nodes: Vec<u64> =
            nodes.map(|(node, &at)| *first.entry(place(node, at)).or_insert(node as u64)).collect();
        (first.len() < first_nodes.len()).then_some(first_nodes)
    }
}

impl MeshVisitor for NodePositions {
    fn node(&mut self, _: &Cursor<'_>, _: u64, _: u64, x_at: usize, at: [f64; 2]) {
        self.points.push(at);
        self.x_at.push(x_at);
    }

    fn asks_for_data(&self) -> bool {
        true
    }

    fn z_array(&mut self, _: &[u8]) -> bool {
        true
    }

    fn point_numbers(&mut self, numbers: PointNumbers) {
        self.z_values = numbers.numbers;
    }
}

/// Visitor that passes each vertex once to another visitor, and all else with the id of the vertex's first node.
/// Forwards the calls that readers of VTK XML make.
pub(crate) struct Welder<'v> {
    visitor: &'v mut dyn MeshVisitor,
    /// For each node, the id of the first node at its position.
    first_nodes: Vec<u64>,
    x_at: Vec<usize>,
    /// Number of nodes that were visited.
    visited: usize,
}

impl<'v> Welder<'v> {
    /// Returns a visitor that joins the nodes at `positions`; `visitor` itself if no two nodes have one position.
    pub(crate) fn new(
        visitor: &'v mut dyn MeshVisitor,
        positions: NodePositions,
    ) -> Result<Welder<'v>, &'v mut dyn MeshVisitor> {
        match positions.first_nodes() {
            Some(first_nodes) => {
                Ok(Welder { visitor, first_nodes, x_at: positions.x_at, visited: 0 })
            }
            None => Err(visitor),
        }
    }

    /// Returns the id of the first node at the position of a node. Unknown ids stay as they are.
    fn first(&self, node: u64) -> u64 {
        let known = usize::try_from(node).ok().and_then(|node| self.first_nodes.get(node));
        known.copied().unwrap_or(node)
    }

    fn all_first(&self, nodes: &[u64]) -> Vec<u64> {
        nodes.iter().map(|&node| self.first(node)).collect()
    }

    /// Returns the index of each node's vertex.
    fn vertices(&self) -> Vec<u32> {
        let mut vertices: Vec<u32> = Vec::with_capacity(self.first_nodes.len());
        let mut next = 0;
        for (node, &first) in self.first_nodes.iter().enumerate() {
            vertices.push(match first == node as u64 {
                true => next,
                false => vertices[first as usize],
            });
            next += u32::from(first == node as u64);
        }
        vertices
    }

    /// Returns all occurrences of each vertex in the file.
    pub(crate) fn finish(self) -> RepeatedVertices {
        let vertices = self.vertices();
        RepeatedVertices { x_at: self.x_at, vertices }
    }
}

impl MeshVisitor for Welder<'_> {
    fn asks_for_nodes(&self) -> bool {
        self.visitor.asks_for_nodes()
    }

    fn expect_nodes(&mut self, count: usize) {
        self.visitor.expect_nodes(count);
    }

    fn node(&mut self, cursor: &Cursor<'_>, id: u64, dimension: u64, x_at: usize, at: [f64; 2]) {
        if self.first(id) == id {
            self.visitor.node(cursor, id, dimension, x_at, at);
        }
        self.visited += 1;
    }

    fn end_nodes(&mut self, cursor: &Cursor<'_>) -> Result<(), ReadError> {
        let nodes = self.first_nodes.iter().enumerate();
        let vertices = nodes.filter(|&(node, &first)| first == node as u64).count();
        let joined = format!("{} points are joined to {vertices} vertices", self.visited);
        self.visitor.remark(Remark::Text(joined));
        self.visitor.end_nodes(cursor)
    }

    fn expect_elements(&mut self, count: usize) {
        self.visitor.expect_elements(count);
    }

    fn visit_element(&mut self, cursor: &Cursor<'_>, element: &Element) -> Result<(), ReadError> {
        let &Element { id, kind, region, mut nodes } = element;
        nodes[..kind.nodes()].iter_mut().for_each(|node| *node = self.first(*node));
        self.visitor.element(cursor, &Element { id, kind, region, nodes })
    }

    fn further_region(&mut self, kind: CellKind, region: [i64; 2]) {
        self.visitor.further_region(kind, region);
    }

    fn polygon(
        &mut self,
        cursor: &Cursor<'_>,
        id: u64,
        region: [i64; 2],
        corners: &[u64],
    ) -> Result<(), ReadError> {
        self.visitor.polygon(cursor, id, region, &self.all_first(corners))
    }

    fn polyline(
        &mut self,
        cursor: &Cursor<'_>,
        id: u64,
        region: [i64; 2],
        nodes: &[u64],
    ) -> Result<(), ReadError> {
        self.visitor.polyline(cursor, id, region, &self.all_first(nodes))
    }

    fn asks_for_ghosts(&self) -> bool {
        self.visitor.asks_for_ghosts()
    }

    /// Forwards ghosts. Calls of `pieces` are not forwarded, as common vertices of two pieces are joined.
    fn ghosts(&mut self, name: &'static str, count: u64, nodes: &[u64]) {
        self.visitor.ghosts(name, count, &self.all_first(nodes));
    }

    fn remark(&mut self, remark: Remark) {
        self.visitor.remark(remark);
    }

    fn asks_for_groups(&self) -> bool {
        self.visitor.asks_for_groups()
    }

    fn region_attributes(&mut self, columns: Vec<RegionAttribute>) {
        self.visitor.region_attributes(columns);
    }

    fn group_scopes(&mut self, groups: &[GroupScope<'_>]) {
        self.visitor.group_scopes(groups);
    }

    fn node_group(&mut self, node: u32, kind: &str, label: &GroupLabel) {
        if let Some(&vertex) = self.vertices().get(node as usize) {
            self.visitor.node_group(vertex, kind, label);
        }
    }

    fn group_name(&mut self, kind: &str, dimension: Option<u8>, tag: i64, name: &[u8]) {
        self.visitor.group_name(kind, dimension, tag, name);
    }

    fn asks_for_data(&self) -> bool {
        self.visitor.asks_for_data()
    }

    fn asks_for_cell_arrays(&self) -> bool {
        self.visitor.asks_for_cell_arrays()
    }

    fn point_array(&mut self, name: &[u8], components: u64, is_real: bool) -> bool {
        self.visitor.point_array(name, components, is_real)
    }

    fn z_array(&mut self, name: &[u8]) -> bool {
        self.visitor.z_array(name)
    }

    fn cell_array(&mut self, name: &[u8], components: u64, is_real: bool) -> bool {
        self.visitor.cell_array(name, components, is_real)
    }

    fn cell_numbers(&mut self, numbers: Vec<f64>, tags: Option<Vec<u64>>) {
        self.visitor.cell_numbers(numbers, tags);
    }

    fn unsupported(&mut self, what: &str) {
        self.visitor.unsupported(what);
    }

    /// Forwards point data with the node of each tuple. Data that differ between the nodes of a vertex, as those of
    /// discontinuous elements do, cannot be replaced.
    fn point_numbers(&mut self, numbers: PointNumbers) {
        let PointNumbers { numbers, nodes, location } = numbers;
        let nodes = match nodes {
            Some(nodes) => self.all_first(&nodes),
            None => self.first_nodes.clone(),
        };
        let each = numbers.len() / nodes.len().max(1);
        let tuple = |at: usize| numbers.get(at * each..(at + 1) * each);
        let bits = |tuple: Option<&[f64]>| -> Vec<u64> {
            tuple.unwrap_or_default().iter().map(|x| x.to_bits()).collect()
        };
        let mut known: HashMap<u64, usize> = HashMap::new();
        let is_continuous = nodes.iter().enumerate().all(|(at, &node)| {
            let first = *known.entry(node).or_insert(at);
            first == at || bits(tuple(first)) == bits(tuple(at))
        });
        let (nodes, location) = (Some(nodes), location.filter(|_| is_continuous));
        self.visitor.point_numbers(PointNumbers { numbers, nodes, location });
    }
}
