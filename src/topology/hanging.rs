//! Hanging nodes: vertices inside an edge of one triangle, where the triangles on the other side of the edge have
//! shorter edges.

use std::f64::consts::{PI, TAU};

use crate::error::MeshError;
use crate::parallel::map_parts;
use crate::topology::Topology;

/// A hanging node: a vertex that lies between the ends of a boundary edge. On the other side of this edge, shorter
/// boundary edges lead from one end through the vertex to the other end. The mesh is open there, as if cut along the
/// edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HangingNode {
    /// Index of the hanging node.
    pub vertex: u32,
    /// Start and end of the boundary edge that contains the node, with the triangle of the edge on the left.
    pub edge: [u32; 2],
}

/// Largest distance of a node from an edge, as a share of the distance along the edge; compared as an angle in radians.
/// Files store few digits, so nodes on edges that are not parallel to an axis are rarely on them exactly.
const MAX_ANGLE: f64 = 1e-3;
/// Largest number of edges of nearly equal direction that are tested at a vertex. Only overlapping triangles have
/// several such edges.
const MAX_TESTED: usize = 64;

impl Topology<'_> {
    /// Returns the hanging nodes of a mesh with its vertices at `points`, ascending, each once. Hanging nodes never
    /// move in a run: the edges on both sides are boundary edges, so every hanging node is on the boundary.
    ///
    /// Both sides must share the end vertices of the long edge. Sides whose ends are separate vertices at equal places,
    /// as slits and interfaces have them on purpose, have no hanging nodes. A node may lie off the edge by up to a
    /// thousandth of the edge length. The search costs about one pass over the triangles.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
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

    /// Returns the boundary edges, each with the third vertex of its corner. Needs no stars: sorts the edges that
    /// join two fixed or boundary vertices, and keeps edges that occur once.
    fn outer_edges(&self) -> Vec<[u32; 3]> {
        let is_held = |&[a, b, _]: &[u32; 3]| !self.free()[a as usize] && !self.free()[b as usize];
        let of_part = |_, part: &[[u32; 3]]| {
            let edges = part.iter().flat_map(|&[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]]);
            edges.filter(is_held).collect::<Vec<_>>()
        };
        let mut edges = map_parts(self.triangles().chunks(1 << 14), of_part).concat();
        // The corner of a quadrilateral begins with a side, and ends with a vertex beside that side.
        edges.extend(self.corner_list().of_quadrilaterals().iter().filter(|t| is_held(t)));
        let ends = |&[a, b, _]: &[u32; 3]| [a.min(b), a.max(b)];
        edges.sort_unstable_by_key(ends);
        let of_one = edges.chunk_by(|a, b| ends(a) == ends(b)).filter(|same| same.len() == 1);
        of_one.map(|same| same[0]).collect()
    }
}

/// Boundary edges grouped by their start vertex, and sorted by direction within a group.
struct Seam<'p> {
    points: &'p [[f64; 2]],
    /// Start, direction in radians from -π to π, and end of each edge, sorted by start and then by direction.
    edges: Vec<(u32, f64, u32)>,
}

impl<'p> Seam<'p> {
    fn new(points: &'p [[f64; 2]], edges: &[[u32; 3]]) -> Self {
        let with_direction = |&[a, b, _]: &[u32; 3]| (a, direction(points, a, b), b);
        let mut edges: Vec<_> = edges.iter().map(with_direction).collect();
        edges.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        Self { points, edges }
    }

    /// Returns the hanging nodes inside the edge from `start` to `end` of a triangle whose third vertex is `corner`.
    /// Follows boundary edges on the other side, from `end` back to `start`; empty if they do not lead there. Edges
    /// that were followed are marked in `used` and are not followed again.
    fn nodes_inside(&self, [start, end, corner]: [u32; 3], used: &mut [bool]) -> Vec<HangingNode> {
        let (mut at, mut nodes) = (end, Vec::new());
        while let Some(edge) = self.toward(at, start).filter(|&edge| !used[edge]) {
            used[edge] = true;
            at = self.edges[edge].2;
            match at {
                at if at == start => return nodes,
                // The path has reached the third vertex: it follows the other two sides of a needle-shaped triangle,
                // not the far side of a gap.
                at if at == corner => break,
                _ => {}
            }
            nodes.push(HangingNode { vertex: at, edge: [start, end] });
        }
        Vec::new()
    }

    /// Returns the index of the boundary edge that starts at `from` in the direction of `to` and ends at `to` or
    /// before.
    fn toward(&self, from: u32, to: u32) -> Option<usize> {
        let own = self.edges.partition_point(|edge| edge.0 < from)
            ..self.edges.partition_point(|edge| edge.0 <= from);
        let wanted = direction(self.points, from, to);
        let all = &self.edges[own.clone()];
        // Directions wrap around from π to -π.
        let least = wanted - MAX_ANGLE;
        let least = if least < -PI { least + TAU } else { least };
        let first = all.partition_point(|edge| edge.1 < least);
        let around = (0..all.len().min(MAX_TESTED)).map(|k| own.start + (first + k) % all.len());
        around.into_iter().find(|&edge| {
            let (_, direction, end) = self.edges[edge];
            let turn = (direction - wanted).abs();
            turn.min(TAU - turn) <= MAX_ANGLE && (end == to || self.is_before(from, end, to))
        })
    }

    /// Returns whether `vertex` is nearer to `from` than `other` is.
    fn is_before(&self, from: u32, vertex: u32, other: u32) -> bool {
        let [from, vertex, other] = [from, vertex, other].map(|v| self.points[v as usize]);
        let length = |p: [f64; 2]| (p[0] - from[0]).hypot(p[1] - from[1]);
        length(vertex) < length(other)
    }
}

/// Returns the angle of the vector between two vertices in radians, from -π to π.
fn direction(points: &[[f64; 2]], from: u32, to: u32) -> f64 {
    let [from, to] = [from, to].map(|v| points[v as usize]);
    (to[1] - from[1]).atan2(to[0] - from[0])
}
