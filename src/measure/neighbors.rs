//! The neighbors of an element across its edges. Elements are numbered as in [`Measured`](super::Measured): first the triangles, then
//! the quadrilaterals.

use crate::topology::Topology;

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
    let corners = topology.corner_list();
    let (at_start, at_end) = (topology.star(start), topology.star(end));
    let from_start = at_start.len() <= at_end.len();
    let (vertex, star) = if from_start { (start, at_start) } else { (end, at_end) };
    if topology.free()[vertex as usize] {
        // The star is counter-clockwise around the vertex: across an edge that starts at the vertex is the previous
        // element, across an edge that ends there the next one.
        if let Some(at) = star.iter().position(|&other| corners.number(other) == of) {
            let step = if from_start { star.len() - 1 } else { 1 };
            visit(corners.number(star[(at + step) % star.len()]));
        }
        return;
    }
    let far = if from_start { end } else { start };
    // The corner at a vertex has the two vertices beside it.
    let has_edge = |corner: &&u32| corners.all()[**corner as usize].contains(&far);
    let others = star.iter().filter(has_edge).map(|&corner| corners.number(corner));
    others.filter(|&other| other != of).for_each(visit);
}

/// Calls `visit` with the ends of each edge of an element, counter-clockwise, and with each element across the edge.
#[inline]
pub(crate) fn for_each_side(
    topology: &Topology<'_>,
    element: usize,
    visit: impl FnMut([u32; 2], usize),
) {
    let triangles = topology.triangles();
    match element.checked_sub(triangles.len()) {
        None => across_sides(topology, element, triangles[element], visit),
        Some(index) => {
            across_sides(topology, element, topology.corner_list().quadrilateral(index), visit);
        }
    }
}

#[inline]
fn across_sides<const N: usize>(
    topology: &Topology<'_>,
    element: usize,
    vertices: [u32; N],
    mut visit: impl FnMut([u32; 2], usize),
) {
    for k in 0..N {
        let ends = [vertices[k], vertices[(k + 1) % N]];
        for_each_across(topology, element, ends, |other| visit(ends, other));
    }
}
