//! The adaptation of a mesh: sizes and stretching that neighboring triangles have in common.

use crate::error::MeshError;
use crate::parallel::{map_parts, map_ranges};
use crate::targets::keep::shape_logarithm;
use crate::targets::surface::Surface;
use crate::targets::tensor::Tensor;
use crate::topology::Topology;

/// Largest number of vertices around which shapes are averaged.
const SAMPLES: usize = 128;
/// Largest number of vertices around which shapes are averaged for the weight of sizes. Around 128 vertices of a boundary
/// layer, the 95th percentile was found to vary by a fifth with the numbering of the vertices.
const SAMPLES_FOR_WEIGHT: usize = 1024;
/// Stretching around [`SAMPLES`] vertices up to which a mesh is certainly not stretched 2.5-fold.
const UNSTRETCHED: f64 = 2.0;
/// Number of triangles that one task searches.
const CHUNK: usize = 1 << 14;

/// How much the sizes and the stretching of triangles vary over a mesh, for choosing between
/// [`Targets::keep_size`](crate::Targets::keep_size), [`Targets::keep_shape`](crate::Targets::keep_shape) and no
/// targets. Averages over the triangles within two rings of a vertex leave out differences between neighbors, so poor
/// triangles do not count as stretched.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Adaptation {
    /// Ratio of the lengths along and across the mean stretching around a vertex, at the 95th percentile of the free
    /// vertices. 1 if triangles are not stretched.
    pub stretching: f64,
    /// Ratio of the sizes around vertices (square roots of areas) at the 95th and at the 5th percentile of the free
    /// vertices. 1 if sizes do not vary.
    pub gradation: f64,
}

impl Adaptation {
    /// Measures the adaptation of a mesh on a surface, around at most 128 free vertices. Both ratios are 1 if no
    /// vertex is free.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn of(
        topology: &Topology<'_>,
        points: &[[f64; 2]],
        surface: Surface,
    ) -> Result<Self, MeshError> {
        Self::around(topology, points, surface, SAMPLES)
    }

    /// Measures the stretching as [`Self::of`] does, around up to 1,024 free vertices if the mesh may be stretched.
    pub(super) fn stretching_for_weight(
        topology: &Topology<'_>,
        points: &[[f64; 2]],
        surface: Surface,
    ) -> Result<f64, MeshError> {
        let Self { stretching, .. } = Self::of(topology, points, surface)?;
        match stretching > UNSTRETCHED {
            true => Ok(Self::around(topology, points, surface, SAMPLES_FOR_WEIGHT)?.stretching),
            false => Ok(stretching),
        }
    }

    /// Measures the adaptation around at most `most` free vertices.
    fn around(
        topology: &Topology<'_>,
        points: &[[f64; 2]],
        surface: Surface,
        most: usize,
    ) -> Result<Self, MeshError> {
        topology.check_count(points)?;
        let triangles = topology.corners();
        let free = topology.free();
        let count = free.iter().filter(|&&is_free| is_free).count();
        let free = (0..).zip(free).filter(|&(_, &is_free)| is_free).map(|(v, _)| v);
        let samples: Vec<u32> = free.step_by(count.div_ceil(most).max(1)).collect();
        // Two searches for the triangles at some vertices take less time than the stars of all vertices.
        let stars = Stars::of(&samples, triangles, points.len());
        let ring = |v: u32| stars.at(v).flat_map(|t| triangles[t as usize]);
        let neighbors: Vec<u32> = samples.iter().flat_map(|&v| ring(v)).collect();
        let wider = Stars::of(&neighbors, triangles, points.len());
        let shapes = map_ranges(samples.len(), 32, |range| {
            let shape = |&v: &u32| {
                // A vertex is listed once for each of its triangles, and a hub has many.
                let mut around: Vec<u32> = ring(v).collect();
                around.sort_unstable();
                around.dedup();
                let mut near: Vec<u32> = around.into_iter().flat_map(|w| wider.at(w)).collect();
                near.sort_unstable();
                near.dedup();
                let logarithm = |&t: &u32| {
                    let lengths = surface.lengths_in(points, &triangles[t as usize]);
                    shape_logarithm(topology, t as usize, points, lengths)
                };
                let sum = near.iter().map(logarithm).fold(Tensor::default(), Tensor::plus);
                sum.times(1.0 / near.len() as f64)
            };
            samples[range].iter().map(shape).collect::<Vec<_>>()
        });
        let ratio = |[low, high]: [f64; 2]| high / low;
        let of_all = |of: &dyn Fn(Tensor) -> f64| {
            let mut all: Vec<f64> = shapes.iter().flatten().map(|&shape| of(shape)).collect();
            all.sort_unstable_by(f64::total_cmp);
            let at = |share: f64| {
                let last = all.len().saturating_sub(1);
                all.get((share * last as f64).round() as usize).copied().unwrap_or(1.0)
            };
            [at(0.05), at(0.95)]
        };
        Ok(Self {
            stretching: of_all(&|shape| ratio(shape.exp().eigenvalues()))[1],
            gradation: ratio(of_all(&|shape| (-0.5 * (shape.0[0] + shape.0[2])).exp())),
        })
    }
}

/// The triangles at some vertices of a mesh, as pairs of vertex and triangle in ascending order.
struct Stars(Vec<[u32; 2]>);

impl Stars {
    /// Searches the triangles of a mesh with `count` vertices.
    fn of(vertices: &[u32], triangles: &[[u32; 3]], count: usize) -> Self {
        let mut is_wanted = vec![false; count];
        vertices.iter().for_each(|&v| is_wanted[v as usize] = true);
        let parts = map_parts(triangles.chunks(CHUNK), |part, triangles| {
            let numbered = (part * CHUNK..).zip(triangles);
            let pairs = numbered.flat_map(|(t, corners)| corners.map(|v| [v, t as u32]));
            pairs.filter(|&[v, _]| is_wanted[v as usize]).collect::<Vec<_>>()
        });
        let mut pairs = parts.concat();
        pairs.sort_unstable();
        Self(pairs)
    }

    /// Returns the triangles at a vertex.
    fn at(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.0.partition_point(|&[v, _]| v < vertex);
        self.0[first..].iter().take_while(move |&&[v, _]| v == vertex).map(|&[_, t]| t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    /// Returns a lattice of 20 by 20 squares, each cut in two, with its points mapped by `to`.
    fn lattice(to: impl Fn([f64; 2]) -> [f64; 2]) -> Mesh {
        let points = (0..441).map(|v| to([f64::from(v % 21), f64::from(v / 21)])).collect();
        let squares = (0..400).map(|k| 21 * (k / 20) + k % 20);
        let triangles = squares.flat_map(|a| [[a, a + 1, a + 22], [a, a + 22, a + 21]]).collect();
        Mesh { points, triangles, ..Mesh::default() }
    }

    fn of(mesh: &Mesh, surface: Surface) -> [f64; 2] {
        let topology = Topology::new(mesh).unwrap();
        let found = Adaptation::of(&topology, &mesh.points, surface).unwrap();
        [found.stretching, found.gradation]
    }

    #[test]
    fn stretching_and_sizes_are_those_of_the_map() {
        // Right triangles of a square lattice have a common stretching of √3 along the diagonal.
        let [stretching, gradation] = of(&lattice(|p| p), Surface::Plane);
        assert!((stretching - 3f64.sqrt()).abs() < 1e-9 && (gradation - 1.0).abs() < 1e-9);
        let [stretching, gradation] = of(&lattice(|[x, y]| [30.0 * x, y]), Surface::Plane);
        assert!(stretching > 20.0 && (gradation - 1.0).abs() < 1e-9, "{stretching} {gradation}");
        let graded = |[x, y]: [f64; 2]| {
            [(0.2 * x).exp() * (0.05 * y).cos(), (0.2 * x).exp() * (0.05 * y).sin()]
        };
        let [_, gradation] = of(&lattice(graded), Surface::Plane);
        assert!((20.0..50.0).contains(&gradation), "{gradation}");
    }

    #[test]
    fn degrees_of_longitude_are_as_long_as_on_the_sphere() {
        let north = lattice(|[x, y]| [2.0 * x, 60.0 + 0.01 * y]);
        let plane = lattice(|[x, y]| [x, 0.01 * y]);
        let [[on_sphere, _], [in_plane, _]] =
            [of(&north, Surface::Sphere), of(&plane, Surface::Plane)];
        assert!((on_sphere / in_plane - 1.0).abs() < 0.01, "{on_sphere} {in_plane}");
    }

    #[test]
    fn a_mesh_without_free_vertices_is_not_adapted() {
        let points = vec![[0.0, 0.0], [9.0, 0.0], [0.0, 1.0]];
        let mesh = Mesh { points, triangles: vec![[0, 1, 2]], ..Mesh::default() };
        assert_eq!(of(&mesh, Surface::Plane), [1.0, 1.0]);
        let topology = Topology::new(&mesh).unwrap();
        assert!(Adaptation::of(&topology, &[], Surface::Plane).is_err());
    }
}
