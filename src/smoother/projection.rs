//! The conformal projection in which runs move the vertices of a mesh on a sphere.

use crate::mesh::Mesh;
use crate::targets::{Surface, Targets};
use crate::topology::Topology;

/// A mesh of longitudes and latitudes in the Mercator projection. The projection keeps angles, so the shape of a small
/// triangle on the sphere is that of its image in the plane, wherever the vertices move. With latitudes scaled by
/// constants instead, the derivatives of f lack the change of the scale.
pub(super) struct Projection {
    /// The projected mesh, in degrees of longitude at the equator.
    pub(super) mesh: Mesh,
    /// Largest latitude that is projected. Vertices at larger latitudes are projected to this latitude.
    most: f64,
}

impl Projection {
    /// Projects a mesh. `None` if the projection inverts or flattens a triangle: straight edges in longitude and
    /// latitude have curved images, which a sliver does not survive.
    pub(super) fn new(mesh: &Mesh, topology: &Topology<'_>) -> Option<Self> {
        let used =
            || topology.triangles().as_flattened().iter().map(|&v| mesh.points[v as usize][1]);
        let near = used().map(f64::abs).filter(|y| *y < 90.0).fold(0.0, f64::max);
        // The image of a pole is infinitely far. Vertices at a pole do not move.
        let projection = Self { mesh: mesh.clone(), most: 0.5 * (near + 90.0) };
        let points = projection.projected(&mesh.points);
        let is_valid = topology.bad_triangles(&points).is_ok_and(|bad| bad.is_empty());
        is_valid.then_some(Self { mesh: Mesh { points, ..projection.mesh }, ..projection })
    }

    /// Returns the images of points in longitude and latitude.
    pub(super) fn projected(&self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let image = |&[x, y]: &[f64; 2]| {
            [x, y.clamp(-self.most, self.most).to_radians().tan().asinh().to_degrees()]
        };
        points.iter().map(image).collect()
    }

    /// Returns longitudes and latitudes of the images `points`. Vertices whose images have not moved keep the bits that
    /// they have in `given`.
    pub(super) fn unprojected(&self, points: &[[f64; 2]], given: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let point = |((now, was), given): ((&[f64; 2], &[f64; 2]), &[f64; 2])| match now == was {
            true => *given,
            false => [now[0], now[1].to_radians().sinh().atan().to_degrees()],
        };
        points.iter().zip(&self.mesh.points).zip(given).map(point).collect()
    }

    /// Converts targets in longitudes and latitudes to targets in the projection, with the vertices at `points`.
    pub(super) fn targets(&self, targets: &Targets, points: &[[f64; 2]]) -> Targets {
        targets.in_conformal_coordinates(Surface::Sphere, points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(south: f64, north: f64) -> Mesh {
        let points = vec![[0.0, south], [10.0, south], [10.0, north], [0.0, north]];
        Mesh { points, triangles: vec![[0, 1, 2], [0, 2, 3]], fixed: vec![] }
    }

    #[test]
    fn a_projected_point_returns() {
        let mesh = square(-50.0, 80.0);
        let projection = Projection::new(&mesh, &Topology::new(&mesh).unwrap()).unwrap();
        let points = [[3.0, 79.0], [-170.0, 1e-7], [0.5, -49.0], [0.0, 80.0]];
        let images = projection.projected(&points);
        let back = projection.unprojected(&images, &mesh.points);
        for (point, back) in points.iter().zip(back) {
            assert!(point[0] == back[0] && (point[1] - back[1]).abs() < 1e-13, "{back:?}");
        }
        // A vertex that has not moved keeps its bits.
        assert_eq!(projection.unprojected(&projection.mesh.points, &mesh.points), mesh.points);
    }

    #[test]
    fn a_pole_is_projected_beyond_all_other_vertices_of_the_mesh() {
        let mesh = square(89.99, 90.0);
        let projection = Projection::new(&mesh, &Topology::new(&mesh).unwrap()).unwrap();
        let [low, high] = [0, 2].map(|v: usize| projection.mesh.points[v][1]);
        assert!(low < high && high.is_finite());
    }

    #[test]
    fn a_sliver_that_the_projection_would_invert_prevents_the_projection() {
        // Vertex 1 is north of the edge from (0, 50) to (20, 70), but south of the straight edge between the images.
        let points = vec![[0.0, 50.0], [10.0, 60.01], [20.0, 70.0], [10.0, 40.0]];
        let mesh = Mesh { points, triangles: vec![[0, 2, 1], [0, 3, 2]], fixed: vec![] };
        let topology = Topology::new(&mesh).unwrap();
        assert!(topology.bad_triangles(&mesh.points).unwrap().is_empty());
        assert!(Projection::new(&mesh, &topology).is_none());
    }
}
