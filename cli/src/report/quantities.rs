//! The parts of a mesh with values in the range of a threshold.

use std::cell::OnceCell;

use gpu_smooth::measure::{InnerEdge, Measure, Measured, WhyLarge};
use gpu_smooth::topology::signed_area;

use crate::limits::{Part, Quantity, Threshold};
use crate::load::LoadedMesh;
use crate::report::place::Place;
use crate::terminal::numbers::fit8;

/// A mesh with the values of all quantities of its triangles, edges and vertices.
pub(crate) struct Quantities<'m> {
    file: &'m LoadedMesh,
    measured: &'m Measured<'m>,
    edges: OnceCell<Vec<InnerEdge>>,
    is_on_boundary: OnceCell<Vec<bool>>,
}

/// The number of triangles, edges, holes or vertices that violate a threshold, and the worst one.
pub(crate) struct Finding {
    pub(crate) threshold: Threshold,
    /// Number of triangles, edges or vertices with a value in the range.
    pub(crate) count: usize,
    /// Number of triangles, edges or vertices that have the quantity.
    pub(crate) total: usize,
    /// The triangle, edge, hole or vertex with the worst value, even if this value satisfies the limit. `None` if the mesh
    /// has none.
    pub(crate) worst: Option<Worst>,
}

/// The part of a mesh with the worst value of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Worst {
    pub(crate) place: Place,
    pub(crate) value: f64,
}

/// The value of a triangle, an edge or a vertex.
#[derive(Clone, Copy)]
struct Valued {
    index: usize,
    value: f64,
}

impl<'m> Quantities<'m> {
    /// Borrows a mesh, and the measures of its triangles at positions before or after a run.
    pub(crate) fn new(file: &'m LoadedMesh, measured: &'m Measured<'m>) -> Self {
        Self { file, measured, edges: OnceCell::new(), is_on_boundary: OnceCell::new() }
    }

    /// Returns the edges between two triangles.
    pub(crate) fn edges(&self) -> &[InnerEdge] {
        self.edges.get_or_init(|| self.measured.edges())
    }

    /// Returns the reason for which a triangle keeps an angle of 90 degrees or more; `None` if no reason is known.
    pub(crate) fn why_large(&self, triangle: usize) -> Option<WhyLarge> {
        self.measured.why_large(triangle)
    }

    /// Counts the parts with a value in the range of a threshold, and locates the worst part.
    pub(crate) fn finding(&self, threshold: &Threshold) -> Finding {
        let (count, total, worst);
        match threshold.quantity {
            // Measures of triangles need no list of all values.
            Quantity::Measure(measure) if !measure.is_of_edges() => {
                count = self.measured.count_where(measure, |value| threshold.is_met(value)).0;
                total = self.measured.count();
                let found = self.measured.worst(measure, 1);
                worst = found.first().map(|&(index, value)| Valued { index, value });
            }
            _ => {
                let values = self.values(threshold);
                count = values.iter().filter(|part| threshold.is_met(part.value)).count();
                total = values.len();
                let worse = |a: Valued, b: Valued| match threshold.is_worse(b.value, a.value) {
                    true => b,
                    false => a,
                };
                worst = values.into_iter().reduce(worse);
            }
        }
        let worst = worst.map(|Valued { index, value }| {
            let place = self.place(threshold.quantity.part(), index);
            Worst { place, value }
        });
        Finding { threshold: threshold.clone(), count, total, worst }
    }

    /// Returns the values of all parts that have a quantity. Vertices on the boundary have few triangles in every mesh, so
    /// a threshold of small numbers is for vertices inside alone.
    fn values(&self, threshold: &Threshold) -> Vec<Valued> {
        let valued = |(index, value)| Valued { index, value };
        let topology = self.measured.topology();
        match threshold.quantity {
            Quantity::Measure(measure) if measure.is_of_edges() => {
                let values = self.edges().iter().map(|edge| of_edge(measure, edge));
                values.enumerate().map(valued).collect()
            }
            Quantity::Measure(measure) => {
                self.measured.values(measure).into_iter().enumerate().map(valued).collect()
            }
            Quantity::BoundaryCorners => {
                let is_on_boundary = self.is_on_boundary();
                let corners = |triangle: &[u32; 3]| {
                    triangle.iter().filter(|&&v| is_on_boundary[v as usize]).count() as f64
                };
                topology.triangles().iter().map(corners).enumerate().map(valued).collect()
            }
            Quantity::HoleEdges => {
                let points = self.measured.points();
                let is_hole = |vertices: &Vec<u32>| signed_area(points, vertices) < 0.0;
                let holes = topology.boundary_loops().into_iter().filter(is_hole);
                holes.map(|hole| valued((hole[0] as usize, hole.len() as f64))).collect()
            }
            Quantity::Neighbors => {
                let is_on_boundary = self.is_on_boundary();
                let is_counted = |&(v, count): &(usize, usize)| {
                    count > 0 && !(threshold.is_below && is_on_boundary[v])
                };
                let counts = (0..topology.free().len()).map(|v| (v, topology.star(v as u32).len()));
                counts.filter(is_counted).map(|(v, count)| valued((v, count as f64))).collect()
            }
        }
    }

    /// Returns for each vertex whether an edge of a single triangle ends there.
    fn is_on_boundary(&self) -> &[bool] {
        self.is_on_boundary.get_or_init(|| {
            let topology = self.measured.topology();
            let mut is_on_boundary = vec![false; topology.free().len()];
            for v in topology.boundary_edges().into_flattened() {
                is_on_boundary[v as usize] = true;
            }
            is_on_boundary
        })
    }

    fn place(&self, part: Part, index: usize) -> Place {
        match part {
            Part::Triangle => Place::Triangle(self.file.source.triangle_location(index)),
            Part::Vertex | Part::Hole => Place::Vertex(self.file.vertex_place(index as u32)),
            Part::Edge => {
                let mut ends = self.edges()[index].vertices.map(|v| self.file.vertex_place(v));
                ends.sort_by_key(|end| end.id);
                Place::Edge(ends)
            }
        }
    }
}

/// Returns the value of a measure of edges for an edge between two triangles.
pub(crate) fn of_edge(measure: Measure, edge: &InnerEdge) -> f64 {
    match measure {
        Measure::FlowLink => edge.flow_link,
        _ => edge.orthogonality,
    }
}

impl Finding {
    /// Returns a sentence with the number of violations and the place of the worst value. Values have no sign for degrees
    /// if `is_plain` is true.
    pub(crate) fn sentence(&self, is_plain: bool) -> String {
        let Self { threshold, count, total, worst } = self;
        let parts = threshold.quantity.part().noun(false);
        let counted = match count {
            0 => format!("none of {total} {parts} has {threshold}"),
            count => format!("{count} of {total} {parts} have {threshold}"),
        };
        match worst {
            None => counted,
            Some(Worst { place, value }) => {
                let (quantity, value) = (threshold.quantity, written(threshold.quantity, *value));
                let unit = match (quantity.unit(), is_plain) {
                    ("°", true) => " deg",
                    (unit, _) => unit,
                };
                format!("{counted}; the worst is {place}, {quantity} {value}{unit}")
            }
        }
    }
}

/// Formats a value of a quantity in at most eight characters.
pub(crate) fn written(quantity: Quantity, value: f64) -> String {
    if quantity.is_count() { format!("{value}") } else { fit8(value) }
}
