//! The reasons for which no move of free vertices makes a triangle acute.

use crate::measure::measured::Measured;
use crate::topology::predicates::orientation;

/// A reason for which a triangle keeps an angle of 90 degrees or more, wherever the free vertices move, or for which some
/// triangle at the same vertex does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum WhyLarge {
    /// All three corners are fixed. Remedies: let vertices slide, swap an edge, or refine.
    AllFixed,
    /// The largest angle is at a vertex with three or four triangles all around, whose angles are 120 or 90 degrees on
    /// average. Remedies: swap an edge, or refine.
    FewTriangles,
    /// The largest angle is at a fixed vertex on the boundary, whose triangles share an angle of 90 degrees or more each.
    /// Remedies: let the vertex slide, or refine.
    WideFan,
}

impl WhyLarge {
    /// All reasons, in the order of the variants.
    pub const ALL: [Self; 3] = [Self::AllFixed, Self::FewTriangles, Self::WideFan];
}

impl Measured<'_> {
    /// Returns the reason for which the triangle `index` keeps an angle of 90 degrees or more. `None` if all angles are
    /// smaller, if no reason is known, or if the mesh has no such triangle.
    pub fn why_large(&self, index: usize) -> Option<WhyLarge> {
        let topology = self.topology();
        let corners = topology.triangles().get(index)?;
        let angles = self.angles(index);
        let k = (0..3).max_by(|&a, &b| angles[a].total_cmp(&angles[b]))?;
        // An angle of exactly 90 degrees may be rounded.
        const RIGHT: f64 = 90.0 - 1e-9;
        if angles[k] < RIGHT {
            return None;
        }
        let is_free = |v: u32| topology.free()[v as usize];
        if !corners.iter().any(|&v| is_free(v)) {
            return Some(WhyLarge::AllFixed);
        }
        let star = topology.star(corners[k]);
        let around: f64 = star.iter().map(|&t| self.angle_at(t as usize, corners[k])).sum();
        let is_inside = around > 360.0 - 1e-6;
        match is_inside {
            true => (star.len() <= 4).then_some(WhyLarge::FewTriangles),
            false if is_free(corners[k]) => None,
            false => (around >= RIGHT * star.len() as f64).then_some(WhyLarge::WideFan),
        }
    }

    /// Returns the angle of a corner at a vertex, in degrees.
    fn angle_at(&self, triangle: usize, vertex: u32) -> f64 {
        let corners = self.topology().corners()[triangle];
        let k = corners.iter().position(|&v| v == vertex).unwrap_or_default();
        self.angles(triangle)[k]
    }

    /// Returns the three angles of a corner in degrees, in the order of its corners.
    fn angles(&self, triangle: usize) -> [f64; 3] {
        let corners = self.topology().corners()[triangle];
        let [x, y] = self.surface().lengths_in(self.points(), &corners);
        let doubled = orientation(self.points(), &corners).abs() * x * y;
        let at = corners.map(|v| self.points()[v as usize]);
        [0, 1, 2].map(|k| {
            let to = |j: usize| [0, 1].map(|i| (at[(k + j) % 3][i] - at[k][i]) * [x, y][i]);
            let (u, v) = (to(1), to(2));
            doubled.atan2(u[0] * v[0] + u[1] * v[1]).to_degrees()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, Topology};

    fn reasons(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Vec<Option<WhyLarge>> {
        let mesh =
            Mesh { points: points.to_vec(), triangles: triangles.to_vec(), ..Mesh::default() };
        let topology = Topology::new(&mesh).unwrap();
        let measured = Measured::new(points, &topology).unwrap();
        (0..=triangles.len()).map(|t| measured.why_large(t)).collect()
    }

    #[test]
    fn an_obtuse_triangle_of_fixed_corners_stays() {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.1], [0.5, -0.9]];
        let found = reasons(&points, &[[0, 1, 2], [1, 0, 3]]);
        assert_eq!(found, [Some(WhyLarge::AllFixed), None, None]);
    }

    #[test]
    fn a_vertex_of_four_triangles_has_right_angles_at_best() {
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let fan = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let at = |center: [f64; 2]| [&corners[..], &[center]].concat();
        let few = Some(WhyLarge::FewTriangles);
        assert_eq!(reasons(&at([1.0, 1.0]), &fan), [few, few, few, few, None]);
        assert_eq!(reasons(&at([1.0, 0.9]), &fan)[..2], [few, None]);
    }

    #[test]
    fn two_triangles_at_a_reentrant_corner_share_more_than_180_degrees() {
        let points = [[-1.0, -0.3], [0.0, 0.0], [1.0, -0.3], [0.0, 0.8], [1.5, 1.0], [-1.5, 1.0]];
        let fan = [[1, 2, 3], [0, 1, 3], [2, 4, 3], [4, 5, 3], [5, 0, 3]];
        let wide = Some(WhyLarge::WideFan);
        assert_eq!(reasons(&points, &fan)[..2], [wide, wide]);
        // Three triangles share a straight angle.
        let points = [[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0], [-0.5, 0.9], [0.5, 0.9], [0.0, 2.0]];
        let fan = [[1, 2, 4], [1, 4, 3], [1, 3, 0], [3, 4, 5], [2, 5, 4], [0, 3, 5]];
        assert_eq!(reasons(&points, &fan)[..4], [None; 4]);
    }
}
