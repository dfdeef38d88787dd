//! Hanging nodes: vertices inside an edge of one triangle, on whose other side triangles have shorter edges.

use std::f64::consts::{PI, TAU};

use crate::error::MeshError;
use crate::parallel::map_parts;
use crate::topology::Topology;

/// A hanging node: a vertex on the boundary between the ends of a boundary edge, on whose other side shorter boundary
/// edges lead through the vertex from one end to the other. The mesh is open there, as if cut along the edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HangingNode {
    /// The vertex.
    pub vertex: u32,
    /// The ends of the edge that it is inside of, with the edge's triangle on the left.
    pub edge: [u32; 2],
}

/// How far from an edge a node may be, as a share of the distance along it. Files hold few digits of points on edges
/// that are not along an axis, so these are rarely on them exactly.
const OFF: f64 = 1e-3;
/// How many edges in nearly one direction are looked at, at each vertex. Only overlapping triangles have several.
const MOST: usize = 64;

impl Topology<'_> {
    /// Returns the hanging nodes of a mesh with its vertices at `points`, ascending, each once. They are on the boundary,
    /// as the edges on both sides are, and do not move.
    ///
    /// The ends of the edge must be vertices of both sides, so that sides with vertices of their own at the same places,
    /// as slits and interfaces have them on purpose, have none. A node may be off the edge by a thousandth of its length.
    /// This takes about as long as one pass over the triangles.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex.
    pub fn hanging_nodes(&self, points: &[[f64; 2]]) -> Result<Vec<HangingNode>, MeshError> {
        self.check_count(points)?;
        let edges = self.outer_edges();
        let seam = Seam::new(points, &edges);
        let mut used = vec![false; edges.len()];
        let mut nodes: Vec<HangingNode> =
            edges.iter().flat_map(|&edge| seam.nodes_inside(edge, &mut used)).collect();
        nodes.sort_unstable_by_key(|node| (node.vertex, node.edge));
        nodes.dedup_by_key(|node| node.vertex);
        Ok(nodes)
    }

    /// Returns the boundary edges, each with the third corner of its triangle. They are found without the triangles at
    /// each vertex: the ends of a boundary edge are not free.
    fn outer_edges(&self) -> Vec<[u32; 3]> {
        let is_held = |&[a, b, _]: &[u32; 3]| !self.free()[a as usize] && !self.free()[b as usize];
        let of_part = |_, part: &[[u32; 3]]| {
            let edges = part.iter().flat_map(|&[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]]);
            edges.filter(is_held).collect::<Vec<_>>()
        };
        let mut edges = map_parts(self.triangles().chunks(1 << 14), of_part).concat();
        let ends = |&[a, b, _]: &[u32; 3]| [a.min(b), a.max(b)];
        edges.sort_unstable_by_key(ends);
        let of_one = edges.chunk_by(|a, b| ends(a) == ends(b)).filter(|same| same.len() == 1);
        of_one.map(|same| same[0]).collect()
    }
}

/// The boundary edges that start at each vertex, by direction.
struct Seam<'p> {
    points: &'p [[f64; 2]],
    /// Start, direction from -π to π, and end of each edge. Sorted by start and direction.
    edges: Vec<(u32, f64, u32)>,
}

impl<'p> Seam<'p> {
    fn new(points: &'p [[f64; 2]], edges: &[[u32; 3]]) -> Self {
        let with_direction = |&[a, b, _]: &[u32; 3]| (a, direction(points, a, b), b);
        let mut edges: Vec<_> = edges.iter().map(with_direction).collect();
        edges.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        Self { points, edges }
    }

    /// Returns the nodes inside an edge, which is given with the third corner of its triangle, if edges on its other side
    /// lead through them from its end to its start. `used` are the edges that were gone along, each once.
    fn nodes_inside(&self, [start, end, corner]: [u32; 3], used: &mut [bool]) -> Vec<HangingNode> {
        let (mut at, mut nodes) = (end, Vec::new());
        while let Some(edge) = self.toward(at, start).filter(|&edge| !used[edge]) {
            used[edge] = true;
            at = self.edges[edge].2;
            match at {
                at if at == start => return nodes,
                // The other sides of a needle, not of a gap.
                at if at == corner => break,
                _ => {}
            }
            nodes.push(HangingNode { vertex: at, edge: [start, end] });
        }
        Vec::new()
    }

    /// Returns the edge from a vertex that goes toward another, and not beyond it.
    fn toward(&self, from: u32, to: u32) -> Option<usize> {
        let own = self.edges.partition_point(|edge| edge.0 < from)
            ..self.edges.partition_point(|edge| edge.0 <= from);
        let wanted = direction(self.points, from, to);
        let all = &self.edges[own.clone()];
        // Directions go on from π to -π.
        let least = wanted - OFF;
        let least = if least < -PI { least + TAU } else { least };
        let first = all.partition_point(|edge| edge.1 < least);
        let around = (0..all.len().min(MOST)).map(|k| own.start + (first + k) % all.len());
        around.into_iter().find(|&edge| {
            let (_, direction, end) = self.edges[edge];
            let turn = (direction - wanted).abs();
            turn.min(TAU - turn) <= OFF && (end == to || self.is_before(from, end, to))
        })
    }

    /// Whether a vertex comes before another, seen from a third.
    fn is_before(&self, from: u32, vertex: u32, other: u32) -> bool {
        let [from, vertex, other] = [from, vertex, other].map(|v| self.points[v as usize]);
        let length = |p: [f64; 2]| (p[0] - from[0]).hypot(p[1] - from[1]);
        length(vertex) < length(other)
    }
}

/// Returns the direction from a vertex to another, from -π to π.
fn direction(points: &[[f64; 2]], from: u32, to: u32) -> f64 {
    let [from, to] = [from, to].map(|v| points[v as usize]);
    (to[1] - from[1]).atan2(to[0] - from[0])
}
