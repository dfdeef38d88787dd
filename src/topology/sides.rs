//! The sides of elements on the boundary.

use crate::parallel::counting_sort::Groups;
use crate::topology::corners::Corners;
use crate::topology::stars::others_at_edge;

/// A side of an element: from the vertex at `place` of a corner to the vertex at the next place. Sides of a quadrilateral
/// start at the first place of its corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct BoundaryEdge {
    pub(super) corner: u32,
    pub(super) place: u32,
}

impl BoundaryEdge {
    /// Returns the vertices at which the edge starts and ends, with its element on the left.
    pub(super) fn ends(self, corners: &Corners<'_>) -> [u32; 2] {
        let vertices = corners.all()[self.corner as usize];
        [vertices[self.place as usize], vertices[(self.place as usize + 1) % 3]]
    }

    /// Returns the first corner of the element across the edge, `None` for a boundary edge.
    pub(super) fn across(self, corners: &Corners<'_>, stars: &Groups) -> Option<u32> {
        let element = corners.first(self.corner);
        others_at_edge(corners, stars, element, self.ends(corners)).next()
    }
}

/// Returns the boundary edges, those of exactly one element, in the order of the corners. `closed` marks vertices around which the
/// elements form one cycle, whose edges all have two elements.
pub(super) fn boundary_sides(
    corners: &Corners<'_>,
    stars: &Groups,
    closed: &[bool],
) -> Vec<BoundaryEdge> {
    let mut sides = Vec::new();
    for vertex in (0..closed.len()).filter(|&vertex| !closed[vertex]) {
        for &corner in stars.of(vertex) {
            let vertices = corners.all()[corner as usize];
            // The star of a vertex has the corner of a quadrilateral whose first vertex it is.
            let place = vertices.iter().position(|&v| v as usize == vertex).unwrap_or(0) as u32;
            let side = BoundaryEdge { corner, place };
            let [_, end] = side.ends(corners);
            if !closed[end as usize] && side.across(corners, stars).is_none() {
                sides.push(side);
            }
        }
    }
    sides.sort_unstable();
    sides
}
