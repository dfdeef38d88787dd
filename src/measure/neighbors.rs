//! The neighbors of an element across its edges. Elements are numbered as in [`Measured`](super::Measured): first the triangles, then
//! the quadrilaterals.

use crate::topology::Topology;

/// Returns the number of the element of a corner.
#[inline]
fn element_of(topology: &Topology<'_>, corner: u32) -> usize {
    let (corner, triangles) = (corner as usize, topology.triangles().len());
    if corner < triangles { corner } else { triangles + (corner - triangles) / 4 }
}

/// Calls `visit` with the element across the edge from `start` to `end` of the element `of`. Does nothing if the edge is a boundary
/// edge.
///
/// Searches the star of the vertex that has fewer elements. For all edges of a mesh this takes linear time, however
/// many elements some vertices have.
#[inline]
pub(crate) fn for_each_across(
    topology: &Topology<'_>,
    of: usize,
    [start, end]: [u32; 2],
    mut visit: impl FnMut(usize),
) {
    let (at_start, at_end) = (topology.star(start), topology.star(end));
    let from_start = at_start.len() <= at_end.len();
    let (vertex, star) = if from_start { (start, at_start) } else { (end, at_end) };
    if topology.free()[vertex as usize] {
        // The star is counter-clockwise around the vertex: across an edge that starts at the vertex is the previous
        // element, across an edge that ends there the next one.
        if let Some(at) = star.iter().position(|&other| element_of(topology, other) == of) {
            let step = if from_start { star.len() - 1 } else { 1 };
            visit(element_of(topology, star[(at + step) % star.len()]));
        }
        return;
    }
    let far = if from_start { end } else { start };
    // The corner at a vertex has the two vertices beside it.
    let has_edge = |corner: &&u32| topology.corners()[**corner as usize].contains(&far);
    let others = star.iter().filter(has_edge).map(|&corner| element_of(topology, corner));
    others.filter(|&other| other != of).for_each(visit);
}

/// Calls `visit` with the ends of each edge of an element, counter-clockwise, and with each element across the edge.
#[inline]
pub(crate) fn for_each_side(
    topology: &Topology<'_>,
    element: usize,
    mut visit: impl FnMut([u32; 2], usize),
) {
    let triangles = topology.triangles();
    match element.checked_sub(triangles.len()) {
        None => {
            let corners = triangles[element];
            for k in 0..3 {
                let ends = [corners[k], corners[(k + 1) % 3]];
                for_each_across(topology, element, ends, |other| visit(ends, other));
            }
        }
        Some(index) => {
            let corners = topology.corner_list().quadrilateral(index);
            for k in 0..4 {
                let ends = [corners[k], corners[(k + 1) % 4]];
                for_each_across(topology, element, ends, |other| visit(ends, other));
            }
        }
    }
}
