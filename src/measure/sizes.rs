//! The measure `size-ratio`, which depends on the neighbors of an element.

use crate::measure::neighbors::for_each_side;
use crate::parallel::collect;
use crate::targets::Surface;
use crate::topology::Topology;
use crate::topology::predicates::orientation;

/// Returns the areas of triangles on a surface, doubled and without sign.
pub(crate) fn doubled_areas(
    surface: Surface,
    points: &[[f64; 2]],
    triangles: &[[u32; 3]],
) -> Vec<f64> {
    collect(triangles.len(), |t| {
        let [x, y] = surface.lengths_in(points, &triangles[t]);
        orientation(points, &triangles[t]).abs() * x * y
    })
}

/// Returns for each element the largest ratio of areas between the element and a neighbor across an edge, larger over
/// smaller. 1 if the element has no neighbor, infinite if the element or a neighbor is flat.
pub(crate) fn size_ratios(
    surface: Surface,
    points: &[[f64; 2]],
    topology: &Topology<'_>,
) -> Vec<f64> {
    let mut areas = doubled_areas(surface, points, topology.triangles());
    // Each point of a quadrilateral is in two of its corner triangles.
    let of_corners = doubled_areas(surface, points, topology.corner_list().of_quadrilaterals());
    areas.extend(of_corners.chunks_exact(4).map(|four| four.iter().sum::<f64>() / 2.0));
    // If stars have been dropped, this line computes them again before several threads need them.
    topology.star(0);
    collect(areas.len(), |element| {
        let mut most = 1.0;
        for_each_side(topology, element, |_, other| {
            let (own, other) = (areas[element], areas[other]);
            let ratio = own.max(other) / own.min(other);
            // The ratio is NaN if both areas are zero or both are infinite.
            most = if ratio.is_nan() { f64::INFINITY } else { ratio.max(most) };
        });
        most
    })
}
