//! A mesh with vertices at given positions, for the measurement of its triangles.

use std::sync::OnceLock;

use crate::error::MeshError;
use crate::measure::edges::{InnerEdge, WorstEdges, inner_edges, worst_edges};
use crate::measure::sizes::{doubled_areas, size_ratios};
use crate::measure::table::Measure;
use crate::measure::triangle::Triangle;
use crate::parallel::{collect, map_ranges};
use crate::targets::Surface;
use crate::topology::Topology;

const CHUNK: usize = 1 << 12;

/// A mesh with vertices at given positions, whose triangles can be measured by each [`Measure`]. All threads share the
/// work.
///
/// ```
/// use gpu_smooth::{measure::{Measure, Measured}, Mesh, Topology};
///
/// let mesh = Mesh {
///     points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]],
///     triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
///     fixed: vec![],
///     ..Mesh::default(),
/// };
/// let topology = Topology::new(&mesh)?;
/// let measured = Measured::new(&mesh.points, &topology)?;
/// let [angle] = &measured.statistics(&[Measure::MinAngle])[..] else { panic!() };
/// assert_eq!((angle.count, angle.min, angle.max), (4, 45.0, 45.0));
/// # Ok::<(), gpu_smooth::MeshError>(())
/// ```
pub struct Measured<'a> {
    points: &'a [[f64; 2]],
    topology: &'a Topology<'a>,
    surface: Surface,
    mean_area: f64,
    size_ratios: OnceLock<Vec<f64>>,
    worst_edges: OnceLock<Vec<WorstEdges>>,
}

impl<'a> Measured<'a> {
    /// Borrows the triangles of `topology`, with vertices at `points`: one plane point per vertex of the mesh, in any
    /// unit.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn new(points: &'a [[f64; 2]], topology: &'a Topology<'a>) -> Result<Self, MeshError> {
        Self::on(Surface::Plane, points, topology)
    }

    /// Borrows the triangles of `topology`, with vertices at `points`: one pair of coordinates on `surface` per vertex
    /// of the mesh. Lengths and angles are measured on the surface, by its metric at the center of each triangle.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn on(
        surface: Surface,
        points: &'a [[f64; 2]],
        topology: &'a Topology<'a>,
    ) -> Result<Self, MeshError> {
        topology.check_count(points)?;
        let areas = doubled_areas(surface, points, topology);
        let sums = map_ranges(areas.len(), CHUNK, |range| areas[range].iter().sum::<f64>());
        let mean_area = sums.iter().sum::<f64>() / 2.0 / areas.len() as f64;
        let (size_ratios, worst_edges) = (OnceLock::new(), OnceLock::new());
        Ok(Self { points, topology, surface, mean_area, size_ratios, worst_edges })
    }

    /// Returns the positions of the vertices.
    pub fn points(&self) -> &[[f64; 2]] {
        self.points
    }

    /// Returns the topology with the measured triangles.
    pub fn topology(&self) -> &Topology<'a> {
        self.topology
    }

    /// Returns the number of triangles.
    pub fn count(&self) -> usize {
        self.topology.triangles().len()
    }

    /// Returns the surface on which the vertices have their coordinates.
    pub(crate) fn surface(&self) -> Surface {
        self.surface
    }

    /// Computes the size ratios and the worst edges of all triangles if `measures` need them, before any triangle is
    /// measured. Lazy computation inside a parallel loop could deadlock: the scheduler could give a thread that waits for
    /// the ratios a task that also waits.
    pub(crate) fn prepare(&self, measures: &[Measure]) {
        if measures.contains(&Measure::SizeRatio) && self.size_ratios.get().is_none() {
            // If another caller has set the ratios first, they have equal values.
            let _ = self.size_ratios.set(size_ratios(self.surface, self.points, self.topology));
        }
        let needs_edges = measures.iter().any(|measure| measure.is_of_edges());
        if needs_edges && self.worst_edges.get().is_none() {
            let _ = self.worst_edges.set(worst_edges(self.surface, self.points, self.topology));
        }
    }

    /// Returns a triangle with all data that the measures given to [`Self::prepare`] need.
    #[inline]
    pub(crate) fn triangle(&self, index: usize) -> Triangle {
        let corners = &self.topology.triangles()[index];
        let size_ratio = self.size_ratios.get().map_or(f64::NAN, |ratios| ratios[index]);
        let worst_edges = self.worst_edges.get().map(|edges| edges[index]);
        let lengths = self.surface.lengths_in(self.points, corners);
        let points = corners.map(|v| self.points[v as usize]);
        let mut triangle = Triangle::new(points, lengths, self.mean_area, size_ratio);
        triangle.worst_edges = worst_edges;
        triangle
    }

    /// Returns the value of a measure for the triangle `index`, NaN if the mesh has no triangle of this index.
    pub fn value(&self, measure: Measure, index: usize) -> f64 {
        self.prepare(&[measure]);
        if index < self.count() { measure.value(&self.triangle(index)) } else { f64::NAN }
    }

    /// Returns the value of a measure for each triangle, in the order of the mesh.
    pub fn values(&self, measure: Measure) -> Vec<f64> {
        self.prepare(&[measure]);
        collect(self.count(), |t| measure.value(&self.triangle(t)))
    }

    /// Returns the edges between two triangles with their measures, in the order of the triangle with the smaller index.
    /// Where more than two triangles share an edge, each pair of them has an entry.
    pub fn edges(&self) -> Vec<InnerEdge> {
        inner_edges(self.surface, self.points, self.topology)
    }
}
