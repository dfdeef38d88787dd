//! The normalized positions of the vertices of a layout.

use glam::DVec2;

use crate::layout::normalization::normalization;
use crate::mesh::Mesh;
use crate::parallel::{collect, map_parts};
use crate::topology::{Corners, Topology};

/// The normalized positions of the vertices of a layout, which are (x - center) · scale.
#[derive(Debug)]
pub(super) struct Placement {
    pub(super) positions: Vec<DVec2>,
    pub(super) center: DVec2,
    pub(super) scale: f64,
}

impl Placement {
    /// Normalizes the points of the `vertices` of a mesh that some element uses. Returns the mean area of triangles in
    /// normalized units too; see [`mean_area`]. `corners` have indices in `vertices`.
    pub(super) fn of(
        mesh: &Mesh,
        topology: &Topology<'_>,
        vertices: &[u32],
        corners: &Corners<'_>,
    ) -> (Self, f64) {
        let (center, scale, exact_mean) = normalization(mesh, topology, vertices);
        let normalized = |v: u32| (DVec2::from(mesh.points[v as usize]) - center) * scale;
        let positions: Vec<DVec2> = collect(vertices.len(), |i| normalized(vertices[i]));
        let area = |t: &[u32; 3]| {
            let [p, q, r] = t.map(|v| positions[v as usize]);
            0.5 * (q - p).perp_dot(r - p)
        };
        // The rounded areas of very thin triangles may add up to zero.
        let mean_area = match mean_area(corners, area) {
            mean if mean > 0.0 => mean,
            _ => exact_mean,
        };
        (Self { positions, center, scale }, mean_area)
    }
}

/// Returns the mean area of the triangles of a mesh, given the area of a corner. In a mesh with quadrilaterals, the result is
/// the area of the equilateral triangle whose edge is the side of the square that quadrilaterals are to become, so that all
/// ideal elements together have the area of the mesh.
pub(super) fn mean_area(corners: &Corners<'_>, area: impl Fn(&[u32; 3]) -> f64 + Sync) -> f64 {
    let total = match corners.of_quadrilaterals() {
        [] => sum(corners.triangles(), area),
        // Each point of a convex quadrilateral is in two of its corners.
        of_quadrilaterals => sum(corners.triangles(), &area) + 0.5 * sum(of_quadrilaterals, &area),
    };
    total / corners.equivalent_triangles()
}

/// Returns the sum of `of` over corners, added in an order that does not depend on the number of threads.
fn sum(corners: &[[u32; 3]], of: impl Fn(&[u32; 3]) -> f64 + Sync) -> f64 {
    let sums = map_parts(corners.chunks(4096), |_, part| part.iter().map(&of).sum::<f64>());
    sums.iter().sum()
}
