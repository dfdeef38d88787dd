//! The Mercator projection, in which runs move the vertices of a mesh on a sphere.

use glam::DVec2;

use crate::mesh::Mesh;
use crate::metric::Dual;
use crate::parallel::pace::now;
use crate::topology::Topology;

/// The Mercator projection of longitudes and latitudes. Images are in degrees of longitude at the equator. The projection
/// keeps angles, so the shape of a small triangle on the sphere is that of its image in the plane, wherever the vertices
/// move. With latitudes scaled by constants instead, the derivatives of f lack the change of the scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mercator {
    /// Largest latitude that is projected. Vertices at larger latitudes are projected to this latitude.
    most: f64,
}

impl Mercator {
    /// Returns the projection of a mesh and the projected mesh. `None` if the projection inverts or flattens a triangle:
    /// straight edges in longitude and latitude have curved images, which a sliver does not survive.
    pub(crate) fn of(mesh: &Mesh, topology: &Topology<'_>) -> Option<(Self, Mesh)> {
        let (projection, projected) = Self::with_slivers(mesh, topology);
        let is_valid = now(topology.infeasible(&projected.points)).is_none();
        is_valid.then_some((projection, projected))
    }

    /// Returns the projection of a mesh and the projected mesh, in which slivers may be inverted or flat.
    pub(crate) fn with_slivers(mesh: &Mesh, topology: &Topology<'_>) -> (Self, Mesh) {
        let used = || topology.corners().as_flattened().iter().map(|&v| mesh.points[v as usize][1]);
        let near = used().map(f64::abs).filter(|y| *y < 90.0).fold(0.0, f64::max);
        // The image of a pole is infinitely far. Vertices at a pole do not move.
        let projection = Self { most: 0.5 * (near + 90.0) };
        let points = mesh.points.iter().map(|&point| projection.image(point)).collect();
        (projection, Mesh { points, ..mesh.clone() })
    }

    /// Returns the image of a longitude and latitude.
    pub(crate) fn image(self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x, y.clamp(-self.most, self.most).to_radians().tan().asinh().to_degrees()]
    }

    /// Returns the longitude and latitude of an image.
    pub(crate) fn point([x, y]: [f64; 2]) -> [f64; 2] {
        [x, y.to_radians().sinh().atan().to_degrees()]
    }
}

/// Conversion between the normalized positions of a problem and the coordinates of its mesh. Coordinates of the mesh are
/// in the normalized unit here too, and equal the positions if the mesh is not projected.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshCoordinates {
    projection: Option<Mercator>,
    /// Center of the normalization in the second coordinate.
    center: f64,
    scale: f64,
}

impl MeshCoordinates {
    /// Returns the conversion for positions (x - `center`) · `scale` of images x.
    pub(super) fn new(projection: Option<Mercator>, center: DVec2, scale: f64) -> Self {
        Self { projection, center: center.y, scale }
    }

    /// Returns whether vertices move in a projection, so that coordinates of the mesh differ from positions.
    pub(crate) fn is_projected(self) -> bool {
        self.projection.is_some()
    }

    /// Returns the coordinates of the mesh at a position.
    pub(crate) fn at(self, position: DVec2) -> DVec2 {
        if self.projection.is_none() {
            return position;
        }
        let [_, y] = Mercator::point([0.0, self.center + position.y / self.scale]);
        DVec2::new(position.x, y * self.scale)
    }

    /// Returns the position at coordinates of the mesh.
    pub(crate) fn position(self, at: DVec2) -> DVec2 {
        let Some(projection) = self.projection else { return at };
        let [_, y] = projection.image([0.0, at.y / self.scale]);
        DVec2::new(at.x, (y - self.center) * self.scale)
    }

    /// Returns the derivative of the mesh's second coordinate by the second coordinate of the position, and the second
    /// derivative.
    pub(crate) fn slopes(self, position: DVec2) -> [f64; 2] {
        if self.projection.is_none() {
            return [1.0, 0.0];
        }
        let [_, y] = Mercator::point([0.0, self.center + position.y / self.scale]);
        let (sin, cos) = y.to_radians().sin_cos();
        [cos, -(sin * cos).to_radians() / self.scale]
    }

    /// Converts derivatives by the coordinates of the mesh to derivatives by the position.
    pub(crate) fn pull_back(self, of_mesh: Dual, position: DVec2) -> Dual {
        if self.projection.is_none() {
            return of_mesh;
        }
        let [slope, bend] = self.slopes(position);
        let ([x, y], [xx, xy, yy]) = (of_mesh.gradient, of_mesh.hessian);
        let hessian = [xx, slope * xy, slope * slope * yy + bend * y];
        Dual { gradient: [x, slope * y], hessian, ..of_mesh }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(south: f64, north: f64) -> Mesh {
        let points = vec![[0.0, south], [10.0, south], [10.0, north], [0.0, north]];
        Mesh { points, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
    }

    fn projected(mesh: &Mesh) -> Option<(Mercator, Mesh)> {
        Mercator::of(mesh, &Topology::new(mesh).unwrap())
    }

    #[test]
    fn a_projected_point_returns() {
        let (projection, _) = projected(&square(-50.0, 80.0)).unwrap();
        for point in [[3.0, 79.0], [-170.0, 1e-7], [0.5, -49.0], [0.0, 80.0]] {
            let back = Mercator::point(projection.image(point));
            assert!(point[0] == back[0] && (point[1] - back[1]).abs() < 1e-13, "{back:?}");
        }
    }

    #[test]
    fn coordinates_of_the_mesh_return_and_have_the_given_slopes() {
        let (projection, _) = projected(&square(-50.0, 80.0)).unwrap();
        let coordinates = MeshCoordinates::new(Some(projection), DVec2::new(5.0, 32.0), 0.25);
        let h = 1e-5;
        for y in [-12.0, 0.0, 3.0, 20.0] {
            let [low, here, high] = [y - h, y, y + h].map(|y| DVec2::new(1.5, y));
            let at = coordinates.at(here);
            assert!(coordinates.position(at).distance(here) < 1e-13, "{y}");
            let [slope, bend] = coordinates.slopes(here);
            let difference = (coordinates.at(high).y - coordinates.at(low).y) / (2.0 * h);
            assert!((slope - difference).abs() < 1e-9, "{y}: {slope} {difference}");
            let [before, after] = [low, high].map(|at| coordinates.slopes(at)[0]);
            let difference = (after - before) / (2.0 * h);
            assert!((bend - difference).abs() < 1e-9, "{y}: {bend} {difference}");
        }
    }

    #[test]
    fn a_pole_is_projected_beyond_all_other_vertices_of_the_mesh() {
        let (_, mesh) = projected(&square(89.99, 90.0)).unwrap();
        let [low, high] = [0, 2].map(|v: usize| mesh.points[v][1]);
        assert!(low < high && high.is_finite());
    }

    #[test]
    fn a_sliver_that_the_projection_would_invert_prevents_the_projection() {
        // Vertex 1 is north of the edge from (0, 50) to (20, 70), but south of the straight edge between the images.
        let points = vec![[0.0, 50.0], [10.0, 60.01], [20.0, 70.0], [10.0, 40.0]];
        let mesh = Mesh { points, triangles: vec![[0, 2, 1], [0, 3, 2]], ..Mesh::default() };
        let topology = Topology::new(&mesh).unwrap();
        assert!(topology.bad_triangles(&mesh.points).unwrap().is_empty());
        assert!(Mercator::of(&mesh, &topology).is_none());
    }
}
