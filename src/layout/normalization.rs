//! The center and the scale by which positions are normalized.

use glam::DVec2;

use crate::mesh::Mesh;
use crate::parallel::map_parts;
use crate::topology::predicates::orientation;
use crate::topology::{EnclosedArea, Topology};

/// Ratio of the signed sum to the absolute sum of the triangles' areas, below which the boundary replaces the signed sum.
/// Vertices far away then leave few digits of the signed sum.
const TANGLED: f64 = 1e-3;

/// Returns the center to subtract, the power of two that brings the mean area into [0.5, 2], and the mean area after
/// scaling by this power. `used` lists the vertices that some element uses.
pub(super) fn normalization(
    mesh: &Mesh,
    topology: &Topology<'_>,
    used: &[u32],
) -> (DVec2, f64, f64) {
    let (low, high) = bounds(&mesh.points, used);
    let center = DVec2::new(exact_center(low.x, high.x), exact_center(low.y, high.y));
    // The areas are computed from the original points, in units of the bounding box, in which their sum cannot
    // overflow.
    let extent = (high * 0.5 - low * 0.5).max_element();
    let relative = |t: &[u32; 3]| 0.5 * orientation(&mesh.points, t) / extent / extent;
    let sums = |corners: &[[u32; 3]]| {
        let areas = map_parts(corners.chunks(4096), |_, part| {
            part.iter()
                .map(relative)
                .fold([0.0; 2], |[sum, size], area| [sum + area, size + area.abs()])
        });
        [0, 1].map(|k| areas.iter().map(|part| part[k]).sum::<f64>())
    };
    let corners = topology.corner_list();
    let [mut area, mut size] = sums(corners.triangles());
    if corners.quadrilateral_count() > 0 {
        // The corners of a quadrilateral have twice its area.
        let [of_quadrilaterals, sizes] = sums(corners.of_quadrilaterals());
        (area, size) = (area + 0.5 * of_quadrilaterals, size + 0.5 * sizes);
    }
    if area.is_nan() || area < TANGLED * size {
        let enclosed = EnclosedArea::of_edges(&mesh.points, topology.boundary_edges());
        area = 0.5 * enclosed / extent / extent;
    }
    let mean = area / corners.equivalent_triangles();
    let length = mean.sqrt() * extent;
    let scale = (-length.log2().round()).exp2();
    (center, scale, (length * scale).powi(2))
}

/// Returns the lower and the upper corner of the bounding box of vertices.
fn bounds(points: &[[f64; 2]], vertices: &[u32]) -> (DVec2, DVec2) {
    let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let both = |a: (DVec2, DVec2), b: (DVec2, DVec2)| (a.0.min(b.0), a.1.max(b.1));
    let of_part = |_, part: &[u32]| {
        let points = part.iter().map(|&v| DVec2::from(points[v as usize]));
        points.map(|point| (point, point)).fold(none, both)
    };
    map_parts(vertices.chunks(1 << 14), of_part).into_iter().fold(none, both)
}

/// Returns a center that can be subtracted without rounding from all coordinates between `low` and `high`. If no
/// coordinate exceeds twice another, the result is the center of the range (Sterbenz' lemma). Otherwise the result is
/// 0: subtracting the center of the range would cost digits of small elements near the origin. Coordinates are
/// then at most twice the extent, so a center would save one binary digit.
fn exact_center(low: f64, high: f64) -> f64 {
    let (least, most) = (low.abs().min(high.abs()), low.abs().max(high.abs()));
    if low.signum() == high.signum() && most <= 2.0 * least { low * 0.5 + high * 0.5 } else { 0.0 }
}
