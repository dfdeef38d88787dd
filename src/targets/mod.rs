//! Targets: the size, stretching and orientation that elements are to have, vertex by vertex.

mod field;
mod keep;
mod surface;
mod tensor;

use crate::error::MeshError;
use crate::topology::Topology;
pub use field::{Outside, TargetField};
pub use surface::Surface;
pub(crate) use tensor::Tensor;

/// The wanted size, stretching and orientation of elements: for each vertex of a mesh a symmetric positive definite
/// tensor M, under which an element wanted there is equilateral with edges of one length. The quality of a triangle is
/// then that of its image under √M, with the mean of √M at its corners.
///
/// Targets belong to the vertices and move with them. Only the ratios of sizes matter: as the number of triangles is
/// given, all targets are scaled by one factor so that the elements fill the domain.
#[derive(Clone, Debug, PartialEq)]
pub struct Targets {
    /// √M at each vertex.
    maps: Vec<Tensor>,
}

impl Targets {
    /// Makes targets for equilateral elements of one size, for this number of vertices.
    pub fn equilateral(vertices: usize) -> Self {
        Self { maps: vec![Tensor::isotropic(1.0); vertices] }
    }

    /// Makes targets for equilateral elements with the given lengths of edges, one for each vertex, in any unit.
    ///
    /// # Errors
    /// [`MeshError::Target`] if a length is not a positive number.
    pub fn sizes(lengths: &[f64]) -> Result<Self, MeshError> {
        let map = |(v, &length): (usize, &f64)| {
            let is_length = length > 0.0 && length.is_finite() && (1.0 / length).is_finite();
            match is_length {
                true => Ok(Tensor::isotropic(1.0 / length)),
                false => Err(MeshError::Target { vertex: v, problem: "its size is not positive" }),
            }
        };
        Ok(Self { maps: lengths.iter().enumerate().map(map).collect::<Result<_, _>>()? })
    }

    /// Makes targets for elements that are equilateral under the given tensors, one for each vertex, as xx, xy, yy: the
    /// metric of anisotropic mesh adaptation, in any unit to the power -2.
    ///
    /// # Errors
    /// [`MeshError::Target`] if a tensor is not positive definite.
    pub fn tensors(tensors: &[[f64; 3]]) -> Result<Self, MeshError> {
        let map = |(v, &tensor): (usize, &[f64; 3])| {
            let tensor = Tensor(tensor);
            match tensor.is_positive() {
                true => Ok(tensor.sqrt()),
                false => {
                    let problem = "its tensor is not positive definite";
                    Err(MeshError::Target { vertex: v, problem })
                }
            }
        };
        Ok(Self { maps: tensors.iter().enumerate().map(map).collect::<Result<_, _>>()? })
    }

    /// Makes targets for equilateral elements of the sizes that the mesh has on a surface, averaged over `rings` rings
    /// of neighbors.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex.
    pub fn keep_size(
        topology: &Topology<'_>,
        points: &[[f64; 2]],
        surface: Surface,
        rings: u32,
    ) -> Result<Self, MeshError> {
        topology.check_count(points)?;
        Ok(Self { maps: keep::sizes(topology.triangles(), points, surface, rings) })
    }

    /// Makes targets for elements of the size, stretching and orientation that the mesh has, averaged over `rings`
    /// rings of neighbors. This keeps boundary layers and anisotropic adaptation, and removes noise.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex.
    pub fn keep_shape(
        topology: &Topology<'_>,
        points: &[[f64; 2]],
        rings: u32,
    ) -> Result<Self, MeshError> {
        topology.check_count(points)?;
        Ok(Self { maps: keep::shapes(topology.triangles(), points, rings) })
    }

    /// Converts targets in lengths on a surface to targets in its coordinates, with the vertices at `points`. Not for
    /// [`Self::keep_shape`], which takes shapes in coordinates. A vertex that none of `triangles` uses may be anywhere.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex, [`MeshError::IndexOutOfRange`] if a
    /// triangle has a vertex that does not exist, [`MeshError::Target`] if a vertex is not on the surface.
    pub fn seen_on(
        mut self,
        surface: Surface,
        points: &[[f64; 2]],
        triangles: &[[u32; 3]],
    ) -> Result<Self, MeshError> {
        if points.len() != self.maps.len() {
            return Err(MeshError::PointCount { given: points.len(), expected: self.maps.len() });
        }
        surface.check(points, triangles)?;
        if surface == Surface::Plane {
            return Ok(self);
        }
        for (map, &[_, y]) in self.maps.iter_mut().zip(points) {
            *map = map.squared().stretched(surface.lengths(y)).sqrt();
        }
        Ok(self)
    }

    /// Fails if there is not one target for each of the vertices.
    pub(crate) fn check_count(&self, vertices: usize) -> Result<(), MeshError> {
        match self.maps.len() {
            given if given == vertices => Ok(()),
            given => Err(MeshError::ValueCount { expected: vertices, given }),
        }
    }

    /// Makes targets from √M at each vertex.
    pub(crate) fn of_maps(maps: Vec<Tensor>) -> Self {
        Self { maps }
    }

    /// Returns √M at each vertex, as xx, xy, yy.
    pub(crate) fn maps(&self) -> &[Tensor] {
        &self.maps
    }
}
