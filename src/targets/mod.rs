//! Targets: the wanted size, stretching and orientation of elements, vertex by vertex.

mod adaptation;
mod field;
mod keep;
mod surface;
mod tensor;

use std::ops::RangeInclusive;

use crate::error::MeshError;
use crate::topology::Topology;
pub use adaptation::Adaptation;
pub use field::{OutsideReport, TargetField};
pub(crate) use keep::shape_logarithm_of;
pub use surface::Surface;
pub(crate) use tensor::Tensor;

/// The wanted size, stretching and orientation of elements. Each vertex of a mesh has a symmetric positive definite
/// tensor M: an element wanted there is equilateral with edges of length 1 under M. The quality of a triangle is the
/// quality of its image under the mean of √M at its three corners.
///
/// Targets belong to the vertices and move with them. Only the ratios of sizes matter: as the number of triangles is
/// given, a common factor scales all targets so that the elements fill the domain.
#[derive(Clone, Debug, PartialEq)]
pub struct Targets {
    /// √M at each vertex.
    maps: Vec<Tensor>,
    size_weight: f64,
}

/// Lengths whose squares and areas are in the range of double precision.
const SIZES: RangeInclusive<f64> = 1e-100..=1e100;
const OUT_OF_RANGE: &str = "its size is not from 1e-100 to 1e100";

impl Targets {
    /// Makes targets for equilateral elements of equal size, for a mesh with `vertices` vertices.
    pub fn equilateral(vertices: usize) -> Self {
        Self::of_maps(vec![Tensor::isotropic(1.0); vertices])
    }

    /// Makes targets for equilateral elements with the given edge lengths, one length per vertex, in any unit.
    ///
    /// # Errors
    /// [`MeshError::Target`] if a length is not from 1e-100 to 1e100.
    pub fn sizes(lengths: &[f64]) -> Result<Self, MeshError> {
        let map = |(v, &length): (usize, &f64)| match length {
            _ if SIZES.contains(&length) => Ok(Tensor::isotropic(1.0 / length)),
            _ if length > 0.0 => Err(MeshError::Target { vertex: v, problem: OUT_OF_RANGE }),
            _ => Err(MeshError::Target { vertex: v, problem: "its size is not positive" }),
        };
        lengths.iter().enumerate().map(map).collect::<Result<_, _>>().map(Self::of_maps)
    }

    /// Makes targets for elements that are equilateral under the given tensors, one per vertex, as xx, xy, yy. Such a
    /// tensor is the metric of anisotropic mesh adaptation, in any unit to the power -2.
    ///
    /// # Errors
    /// [`MeshError::Target`] if a tensor is not positive definite, or if it stands for lengths that are not from 1e-100 to
    /// 1e100.
    pub fn tensors(tensors: &[[f64; 3]]) -> Result<Self, MeshError> {
        let map = |(v, &tensor): (usize, &[f64; 3])| {
            let tensor = Tensor(tensor);
            let [xx, _, yy] = tensor.0;
            match tensor.is_positive() {
                true if [xx, yy].iter().all(|entry| SIZES.contains(&entry.sqrt())) => {
                    Ok(tensor.sqrt())
                }
                true => Err(MeshError::Target { vertex: v, problem: OUT_OF_RANGE }),
                false => {
                    let problem = "its tensor is not positive definite";
                    Err(MeshError::Target { vertex: v, problem })
                }
            }
        };
        tensors.iter().enumerate().map(map).collect::<Result<_, _>>().map(Self::of_maps)
    }

    /// Makes targets for equilateral elements with the sizes of the mesh's triangles on a surface, averaged over
    /// `rings` rings of neighbors. With 0 rings, the size at a vertex depends on the triangles within two edges of the
    /// vertex. The metric should weigh sizes: with [`Metric::Tmop94`](crate::Metric::Tmop94), 19 of 20 free
    /// vertices keep their size within a factor of 1.3.
    ///
    /// On stretched meshes, equilateral triangles do not fit between the vertices of the boundary, and sizes give way to
    /// shapes. Therefore [`Self::size_weight`] grows with the [stretching](Adaptation::stretching) s of the mesh,
    /// measured around up to 1,024 free vertices: it is 1 up to s = 2.5, and 1 + (s - 2.5) / 2 beyond.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex, [`MeshError::NotFinite`] if a vertex of an
    /// element has a coordinate that is infinite or NaN.
    pub fn keep_size(
        topology: &Topology<'_>,
        points: &[[f64; 2]],
        surface: Surface,
        rings: u32,
    ) -> Result<Self, MeshError> {
        topology.check_count(points)?;
        topology.check_finite(points)?;
        let stretching = Adaptation::stretching_for_weight(topology, points, surface)?;
        let maps = keep::sizes(topology, points, surface, rings);
        Ok(Self { maps, size_weight: keep::size_weight(stretching) })
    }

    /// Makes targets for elements with the size, stretching and orientation of the mesh's triangles, averaged over
    /// `rings` rings of neighbors. These targets keep anisotropic adaptation, and remove noise. Triangles without a free
    /// vertex, such as those of kept [layers](crate::layers), count only at vertices that no other triangle has.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex, [`MeshError::NotFinite`] if a vertex of an
    /// element has a coordinate that is infinite or NaN.
    pub fn keep_shape(
        topology: &Topology<'_>,
        points: &[[f64; 2]],
        rings: u32,
    ) -> Result<Self, MeshError> {
        topology.check_count(points)?;
        topology.check_finite(points)?;
        Ok(Self::of_maps(keep::shapes(topology, points, rings)))
    }

    /// Converts targets in lengths on a surface to targets in its coordinates, with the vertices at `points`. Do not
    /// convert targets of [`Self::keep_shape`]: their lengths are in coordinates already. Vertices that none of
    /// `triangles` uses may be anywhere.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per target, [`MeshError::IndexOutOfRange`] if a
    /// triangle names a vertex that does not exist, [`MeshError::Latitude`] if a vertex is not on the surface.
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

    /// Converts targets in coordinates on a surface to targets in its conformal coordinates, in which a unit of either
    /// coordinate has the length of a unit of the first one. The vertices are at `points`.
    pub(crate) fn in_conformal_coordinates(&self, surface: Surface, points: &[[f64; 2]]) -> Self {
        let map = |(map, &[_, y]): (&Tensor, &[f64; 2])| {
            let [first, second] = surface.lengths(y);
            map.squared().stretched([1.0, first / second]).sqrt()
        };
        Self { maps: self.maps.iter().zip(points).map(map).collect(), ..*self }
    }

    /// Returns the factor by which runs multiply the term of size of the metrics SOFT-SIZE, TMOP-80 and TMOP-94; see
    /// [`Metric::has_size_weight`](crate::Metric::has_size_weight). 1 for all targets but those of [`Self::keep_size`] on
    /// stretched meshes.
    pub fn size_weight(&self) -> f64 {
        self.size_weight
    }

    /// Fails with [`MeshError::ValueCount`] unless there is a target for each of the `vertices` vertices.
    pub(crate) fn check_count(&self, vertices: usize) -> Result<(), MeshError> {
        match self.maps.len() {
            given if given == vertices => Ok(()),
            given => Err(MeshError::ValueCount { expected: vertices, given }),
        }
    }

    /// Makes targets from √M at each vertex.
    fn of_maps(maps: Vec<Tensor>) -> Self {
        Self { maps, size_weight: 1.0 }
    }

    /// Returns √M at each vertex, as xx, xy, yy.
    pub(crate) fn maps(&self) -> &[Tensor] {
        &self.maps
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    /// Products of such lengths were zero or infinite, and encoded sweeps moved nothing without an error.
    #[test]
    fn lengths_beyond_double_precision_are_refused() {
        let problem_of = |made: Result<Targets, MeshError>| match made {
            Err(MeshError::Target { vertex: 1, problem }) => problem,
            other => panic!("{other:?}"),
        };
        for length in [1e-300, 1e300] {
            assert_eq!(problem_of(Targets::sizes(&[1.0, length])), OUT_OF_RANGE);
            let tensor = [1.0 / length, 0.0, 1.0];
            assert_eq!(problem_of(Targets::tensors(&[[1.0, 0.0, 1.0], tensor])), OUT_OF_RANGE);
        }
        for length in [0.0, -1.0, f64::NAN] {
            assert_eq!(problem_of(Targets::sizes(&[1.0, length])), "its size is not positive");
        }
        assert!(Targets::sizes(&[1e-100, 1e100]).is_ok());
    }

    #[test]
    fn targets_of_points_that_are_not_finite_are_refused() {
        let mesh = Mesh {
            points: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let topology = Topology::new(&mesh).unwrap();
        let points = [[0.0, 0.0], [1.0, f64::NAN], [0.0, 1.0]];
        let made = [
            Targets::keep_size(&topology, &points, Surface::Plane, 0),
            Targets::keep_shape(&topology, &points, 0),
        ];
        for error in made.map(Result::unwrap_err) {
            assert!(matches!(error, MeshError::NotFinite { vertex: 1 }), "{error}");
        }
    }
}
