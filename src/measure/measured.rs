//! A mesh with vertices at given positions, for the measurement of its elements.

use std::iter;
use std::sync::OnceLock;

use crate::error::MeshError;
use crate::measure::edges::{InnerEdge, WorstEdges, inner_edges, worst_edges};
use crate::measure::quadrilateral::Quadrilateral;
use crate::measure::sizes::{doubled_areas, size_ratios};
use crate::measure::table::Measure;
use crate::measure::triangle::Triangle;
use crate::mesh::Element;
use crate::parallel::{collect, map_ranges};
use crate::targets::Surface;
use crate::topology::Topology;

const CHUNK: usize = 1 << 12;

/// A mesh with vertices at given positions, whose elements can be measured by each [`Measure`]. All threads share the work.
///
/// Elements are numbered from 0: first all triangles, then all quadrilaterals.
///
/// ```
/// use gpu_smooth::{measure::{Measure, Measured}, Mesh, Topology};
///
/// let mesh = Mesh {
///     points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]],
///     triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
///     fixed: vec![],
///     ..Mesh::default()
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
    /// Borrows the elements of `topology`, with vertices at `points`: one plane point per vertex of the mesh, in any
    /// unit.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn new(points: &'a [[f64; 2]], topology: &'a Topology<'a>) -> Result<Self, MeshError> {
        Self::on(Surface::Plane, points, topology)
    }

    /// Borrows the elements of `topology`, with vertices at `points`: one pair of coordinates on `surface` per vertex
    /// of the mesh. Lengths and angles are measured on the surface, by its metric at the center of each element.
    /// Metrics of a quadrilateral are measured at the center of each corner triangle.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn on(
        surface: Surface,
        points: &'a [[f64; 2]],
        topology: &'a Topology<'a>,
    ) -> Result<Self, MeshError> {
        topology.check_count(points)?;
        let corners = topology.corner_list();
        let sum = |corners| {
            let areas = doubled_areas(surface, points, corners);
            let sums = map_ranges(areas.len(), CHUNK, |range| areas[range].iter().sum::<f64>());
            sums.iter().sum::<f64>()
        };
        // Each point of a quadrilateral is in two of its corner triangles.
        let doubled = sum(corners.triangles()) + sum(corners.of_quadrilaterals()) / 2.0;
        let mean_area = doubled / 2.0 / corners.equivalent_triangles();
        let (size_ratios, worst_edges) = (OnceLock::new(), OnceLock::new());
        Ok(Self { points, topology, surface, mean_area, size_ratios, worst_edges })
    }

    /// Returns the positions of the vertices.
    pub fn points(&self) -> &[[f64; 2]] {
        self.points
    }

    /// Returns the topology with the measured elements.
    pub fn topology(&self) -> &Topology<'a> {
        self.topology
    }

    /// Returns the number of elements: triangles and quadrilaterals.
    pub fn count(&self) -> usize {
        self.topology.element_count()
    }

    /// Returns the element of an index below [`count`](Self::count).
    pub fn element(&self, index: usize) -> Element {
        match index.checked_sub(self.topology.triangles().len()) {
            None => Element::Triangle(index),
            Some(index) => Element::Quadrilateral(index),
        }
    }

    /// Returns the number n of elements with the measure. Elements 0 to n - 1 have the measure.
    pub fn count_with(&self, measure: Measure) -> usize {
        if measure.of_quadrilateral() { self.count() } else { self.topology.triangles().len() }
    }

    /// Returns the surface on which the vertices have their coordinates.
    pub(crate) fn surface(&self) -> Surface {
        self.surface
    }

    /// Computes the size ratios and the worst edges of all elements if `measures` need them, before any element is
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
    fn triangle(&self, index: usize) -> Triangle {
        let corners = &self.topology.triangles()[index];
        let size_ratio = self.size_ratios.get().map_or(f64::NAN, |ratios| ratios[index]);
        let worst_edges = self.worst_edges.get().map(|edges| edges[index]);
        let lengths = self.surface.lengths_in(self.points, corners);
        let points = corners.map(|v| self.points[v as usize]);
        let mut triangle = Triangle::new(points, lengths, self.mean_area, size_ratio);
        triangle.worst_edges = worst_edges;
        triangle
    }

    /// Returns a quadrilateral, given its index among the quadrilaterals.
    fn quadrilateral(&self, index: usize) -> Quadrilateral {
        let corners = self.topology.corner_list();
        let of_corner = |corner: &[u32; 3]| {
            let lengths = self.surface.lengths_in(self.points, corner);
            let points = corner.map(|v| self.points[v as usize]);
            Triangle::new(points, lengths, self.mean_area, f64::NAN)
        };
        let four = &corners.of_quadrilaterals().as_chunks::<4>().0[index];
        let points = four.map(|[own, ..]| self.points[own as usize]);
        let lengths = self.surface.lengths(points.iter().map(|[_, y]| y / 4.0).sum());
        let mut quadrilateral = Quadrilateral::new(points, lengths, four.each_ref().map(of_corner));
        let element = self.topology.place(Element::Quadrilateral(index));
        if let Some(ratios) = self.size_ratios.get() {
            quadrilateral.size_ratio = ratios[element];
        }
        quadrilateral.worst_edges = self.worst_edges.get().map(|edges| edges[element]);
        quadrilateral
    }

    /// Calls `visit` with the companion and the value of each of `measures` that the element `index` has. The companion of a
    /// measure is any item, such as the list that collects its values.
    #[inline]
    pub(crate) fn visit_values<'m, T>(
        &self,
        measures: impl Iterator<Item = (&'m Measure, T)>,
        index: usize,
        mut visit: impl FnMut(T, f64),
    ) {
        match index.checked_sub(self.topology.triangles().len()) {
            None => {
                let triangle = self.triangle(index);
                measures.for_each(|(measure, own)| visit(own, measure.value(&triangle)));
            }
            Some(index) => {
                let quadrilateral = self.quadrilateral(index);
                for (measure, own) in measures.filter(|(measure, _)| measure.of_quadrilateral()) {
                    visit(own, measure.value_of_quadrilateral(&quadrilateral));
                }
            }
        }
    }

    /// Returns the value of a measure, given to [`Self::prepare`], for the element `index`; NaN if the element lacks the measure.
    #[inline]
    pub(crate) fn prepared_value(&self, measure: Measure, index: usize) -> f64 {
        let mut found = f64::NAN;
        self.visit_values(iter::once((&measure, ())), index, |(), value| found = value);
        found
    }

    /// Returns the value of a measure for the element `index`; NaN if the element lacks the measure, or the mesh has no element
    /// of this index.
    pub fn value(&self, measure: Measure, index: usize) -> f64 {
        self.prepare(&[measure]);
        if index < self.count() { self.prepared_value(measure, index) } else { f64::NAN }
    }

    /// Returns the value of a measure for each element: the triangles in the order of the mesh, then the quadrilaterals. NaN for
    /// elements without the measure.
    pub fn values(&self, measure: Measure) -> Vec<f64> {
        self.prepare(&[measure]);
        collect(self.count(), |index| self.prepared_value(measure, index))
    }

    /// Returns the edges between two elements with their measures, in the order of the element with the smaller number.
    /// Where more than two elements share an edge, each pair of them has an entry.
    pub fn edges(&self) -> Vec<InnerEdge> {
        inner_edges(self.surface, self.points, self.topology)
    }
}
