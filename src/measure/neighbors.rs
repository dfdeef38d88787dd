//! The neighbors of a triangle across its edges.

use crate::topology::Topology;

/// Calls `visit` with the triangle across the edge from `start` to `end` of triangle `t`. Does nothing if
/// the edge is a boundary edge, or if a quadrilateral is across the edge.
///
/// Searches the star of the vertex that has fewer triangles. For all edges of a mesh this takes linear time, however
/// many triangles some vertices have.
#[inline]
pub(crate) fn for_each_across(
    topology: &Topology<'_>,
    t: usize,
    [start, end]: [u32; 2],
    mut visit: impl FnMut(usize),
) {
    let triangles = topology.triangles().len();
    let mut visit_triangle = |other: usize| {
        if other < triangles {
            visit(other);
        }
    };
    let (at_start, at_end) = (topology.star(start), topology.star(end));
    let from_start = at_start.len() <= at_end.len();
    let (vertex, star) = if from_start { (start, at_start) } else { (end, at_end) };
    if topology.free()[vertex as usize] {
        // The star is counter-clockwise around the vertex: across an edge that starts at the vertex is the previous
        // triangle, across an edge that ends there the next one.
        if let Some(at) = star.iter().position(|&other| other as usize == t) {
            let step = if from_start { star.len() - 1 } else { 1 };
            visit_triangle(star[(at + step) % star.len()] as usize);
        }
        return;
    }
    let far = if from_start { end } else { start };
    let corners = topology.corners();
    let across = |&other: &usize| other != t && corners[other].contains(&far);
    star.iter().map(|&other| other as usize).filter(across).for_each(visit_triangle);
}
