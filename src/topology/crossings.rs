//! Edges that cross and cannot move. If two such edges cross, the mesh is not valid wherever its free vertices are.

use crate::error::MeshError;
use crate::topology::Topology;
use crate::topology::predicates::orientation;

/// Two edges that cross. The ends of each edge are in ascending order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Crossing {
    /// The two edges as pairs of vertices, in ascending order.
    pub edges: [[u32; 2]; 2],
}

/// An edge with the range of its coordinates along an axis, both ends inclusive.
struct Span {
    ends: [u32; 2],
    low: f64,
    high: f64,
}

impl Topology<'_> {
    /// Returns pairs of edges that cross in a point inside both, by exact predicates. Only edges between two vertices
    /// that are not free are tested, such as boundary edges. No move of free vertices makes a mesh with such a crossing
    /// valid, unless the mesh is meant to overlap itself. At most `most` pairs are returned, in ascending order.
    ///
    /// Two edges do not cross if they touch in an end of either edge, or are collinear and overlap: both sides of a
    /// slit have such edges.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn crossings(&self, points: &[[f64; 2]], most: usize) -> Result<Vec<Crossing>, MeshError> {
        self.check_count(points)?;
        let mut found = Vec::new();
        let edges = self.held_edges();
        // The sweep goes along the axis of the larger extent, as fewer edges then overlap along that axis.
        let axis = if extent(points, &edges, 0) >= extent(points, &edges, 1) { 0 } else { 1 };
        let mut spans: Vec<Span> = edges.iter().map(|&ends| span(points, ends, axis)).collect();
        spans.sort_by(|a, b| a.low.total_cmp(&b.low).then(a.ends.cmp(&b.ends)));
        let mut open: Vec<Span> = Vec::new();
        for next in spans {
            open.retain(|span| span.high >= next.low);
            let crossed = open.iter().filter(|span| cross(points, span.ends, next.ends));
            found.extend(crossed.take(most - found.len()).map(|span| {
                let (one, other) = (span.ends.min(next.ends), span.ends.max(next.ends));
                Crossing { edges: [one, other] }
            }));
            if found.len() == most {
                break;
            }
            open.push(next);
        }
        found.sort_unstable();
        Ok(found)
    }

    /// Returns the edges of which neither end is free, each once, ascending.
    fn held_edges(&self) -> Vec<[u32; 2]> {
        let is_held = |edge: &[u32; 2]| edge.iter().all(|&v| !self.free()[v as usize]);
        let corners = self.corner_list();
        let sides = (0..self.corners().len()).flat_map(|corner| corners.sides(corner));
        let sides = sides.map(|(_, ends)| ends);
        let ascending = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
        let mut edges: Vec<[u32; 2]> = sides.filter(is_held).map(ascending).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }
}

fn span(points: &[[f64; 2]], ends: [u32; 2], axis: usize) -> Span {
    let [a, b] = ends.map(|v| points[v as usize][axis]);
    Span { ends, low: a.min(b), high: a.max(b) }
}

/// Returns the length of the range that all edges together span along an axis.
fn extent(points: &[[f64; 2]], edges: &[[u32; 2]], axis: usize) -> f64 {
    let spans = || edges.iter().map(|&ends| span(points, ends, axis));
    let low = spans().map(|span| span.low).fold(f64::INFINITY, f64::min);
    spans().map(|span| span.high).fold(low, f64::max) - low
}

fn cross(points: &[[f64; 2]], one: [u32; 2], other: [u32; 2]) -> bool {
    if one.iter().any(|v| other.contains(v)) {
        return false;
    }
    let boxes_meet = (0..2).all(|axis| {
        let (one, other) = (span(points, one, axis), span(points, other, axis));
        one.low <= other.high && other.low <= one.high
    });
    let parts = |[a, b]: [u32; 2], [c, d]: [u32; 2]| {
        let (c, d) = (orientation(points, &[a, b, c]), orientation(points, &[a, b, d]));
        c > 0.0 && d < 0.0 || c < 0.0 && d > 0.0
    };
    boxes_meet && parts(one, other) && parts(other, one)
}
