//! The measure `size-ratio`, which depends on the neighbors of a triangle.

use crate::measure::neighbors::for_each_across;
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

/// Returns for each triangle the largest ratio of areas between the triangle and a neighbor across an edge, larger over
/// smaller. 1 if the triangle has no neighbor, infinite if the triangle or a neighbor is flat.
pub(crate) fn size_ratios(
    surface: Surface,
    points: &[[f64; 2]],
    topology: &Topology<'_>,
) -> Vec<f64> {
    let triangles = topology.triangles();
    let areas = doubled_areas(surface, points, triangles);
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
