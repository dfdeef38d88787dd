//! The measure `size-ratio`, which depends on the neighbors of a triangle.

use crate::parallel::collect;
use crate::targets::Surface;
use crate::topology::Topology;
use crate::topology::predicates::orientation;

/// Returns the areas of triangles on a surface, doubled and without sign.
pub(crate) fn doubled_areas(
    surface: Surface,
    points: &[[f64; 2]],
    topology: &Topology<'_>,
) -> Vec<f64> {
    let triangles = topology.triangles();
    collect(triangles.len(), |t| {
        let [x, y] = surface.lengths_in(points, &triangles[t]);
        orientation(points, &triangles[t]).abs() * x * y
    })
}

/// Returns for each triangle the largest ratio of areas between the triangle and a neighbor across an edge, larger over
/// smaller. 1 if the triangle has no neighbor, infinite if the triangle or a neighbor is flat.
pub(crate) fn size_ratios(
    surface: Surface,
    points: &[[f64; 2]],
    topology: &Topology<'_>,
) -> Vec<f64> {
    let areas = doubled_areas(surface, points, topology);
    let triangles = topology.triangles();
    // If stars have been dropped, this line computes them again before several threads need them.
    topology.star(0);
    collect(triangles.len(), |t| {
        let mut most = 1.0;
        for i in 0..3 {
            let edge = [triangles[t][i], triangles[t][(i + 1) % 3]];
            for_each_across(topology, t, edge, |other| {
                let (own, other) = (areas[t], areas[other]);
                let ratio = own.max(other) / own.min(other);
                // The ratio is NaN if both areas are zero or both are infinite.
                most = if ratio.is_nan() { f64::INFINITY } else { ratio.max(most) };
            });
        }
        most
    })
}

/// Calls `visit` with the triangle across the edge from `start` to `end` of triangle `t`; not at all on the boundary.
///
/// Searches the star of the vertex that has fewer triangles. For all edges of a mesh this takes linear time, however
/// many triangles some vertices have.
#[inline]
fn for_each_across(
    topology: &Topology<'_>,
    t: usize,
    [start, end]: [u32; 2],
    mut visit: impl FnMut(usize),
) {
    let (at_start, at_end) = (topology.star(start), topology.star(end));
    let from_start = at_start.len() <= at_end.len();
    let (vertex, star) = if from_start { (start, at_start) } else { (end, at_end) };
    if topology.free()[vertex as usize] {
        // The star is counter-clockwise around the vertex: across an edge that starts at the vertex is the previous
        // triangle, across an edge that ends there the next one.
        if let Some(at) = star.iter().position(|&other| other as usize == t) {
            let step = if from_start { star.len() - 1 } else { 1 };
            visit(star[(at + step) % star.len()] as usize);
        }
        return;
    }
    let far = if from_start { end } else { start };
    let triangles = topology.triangles();
    let across = |&other: &usize| other != t && triangles[other].contains(&far);
    star.iter().map(|&other| other as usize).filter(across).for_each(visit);
}
