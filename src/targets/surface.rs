//! Surfaces on which mesh coordinates are defined: plane and sphere.

use crate::error::MeshError;
use crate::mesh::Element;

/// Meaning of the two coordinates of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Surface {
    /// Lengths in the plane.
    #[default]
    Plane,
    /// Longitude and latitude on a sphere, in degrees.
    Sphere,
}

impl Surface {
    /// Fails with [`MeshError::Latitude`] if a vertex of `triangles` is not on the surface, or with
    /// [`MeshError::IndexOutOfRange`] if a vertex has no point.
    pub(crate) fn check(
        self,
        points: &[[f64; 2]],
        triangles: &[[u32; 3]],
    ) -> Result<(), MeshError> {
        if self == Surface::Plane {
            return Ok(());
        }
        for (index, &vertex) in triangles.as_flattened().iter().enumerate() {
            let Some([_, y]) = points.get(vertex as usize) else {
                let element = Some(Element::Triangle(index / 3));
                let vertices = points.len();
                return Err(MeshError::IndexOutOfRange { element, vertex, vertices });
            };
            if y.is_nan() || y.abs() > 90.0 {
                return Err(MeshError::Latitude { vertex });
            }
        }
        Ok(())
    }

    /// Returns [`Self::lengths`] at the center of a triangle.
    #[inline]
    pub(crate) fn lengths_in(self, points: &[[f64; 2]], triangle: &[u32; 3]) -> [f64; 2] {
        match self {
            Surface::Plane => [1.0, 1.0],
            Surface::Sphere => {
                let [p, q, r] = triangle.map(|v| points[v as usize][1]);
                self.lengths((p + q + r) / 3.0)
            }
        }
    }

    /// Returns the lengths on the surface of a unit of each coordinate, at points with the second coordinate `y`. The
    /// unit of length on the sphere is a degree of latitude.
    pub(crate) fn lengths(self, y: f64) -> [f64; 2] {
        match self {
            Surface::Plane => [1.0, 1.0],
            Surface::Sphere => [y.to_radians().cos(), 1.0],
        }
    }
}
