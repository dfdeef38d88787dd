//! The parts of a mesh with values in the range of a threshold.

use std::cell::OnceCell;
use std::f64::consts::PI;
use std::ops::Range;

use gpu_smooth::Element;
use gpu_smooth::measure::{InnerEdge, Measured, WhyLarge};
use gpu_smooth::topology::signed_area;

use crate::error::CliError;
use crate::limits::{Part, Quantity, Threshold};
use crate::load::LoadedMesh;
use crate::load::Place;
use crate::load::remarks::degrees;
use crate::profiles::Elements;
use crate::terminal::numbers::fit8;

/// A mesh with the values of all quantities of its elements, edges and vertices.
pub(crate) struct Quantities<'m> {
    file: &'m LoadedMesh,
    measured: &'m Measured<'m>,
    /// The depth of each vertex, NaN without one; `None` if no quantity needs depths, or if the file has none.
    depths: Option<Vec<f64>>,
    edges: OnceCell<Vec<InnerEdge>>,
    is_on_boundary: OnceCell<Vec<bool>>,
}

/// The number of elements, edges, holes or vertices that violate a threshold, and the worst one.
pub(crate) struct Finding {
    pub(crate) threshold: Threshold,
    /// Name of several parts, such as `triangles`.
    pub(crate) parts: &'static str,
    /// Number of parts beyond the threshold.
    pub(crate) count: usize,
    /// Number of parts that have the quantity.
    pub(crate) total: usize,
    /// The element, edge, hole or vertex with the worst value, even if this value satisfies the limit. `None` if the mesh
    /// has none.
    pub(crate) worst: Option<Worst>,
}

/// The part of a mesh with the worst value of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Worst {
    pub(crate) place: Place,
    pub(crate) value: f64,
}

/// The kinds of elements that a search for the worst part visits.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Among {
    All,
    Only(Elements),
}

/// The value of an element, an edge or a vertex.
#[derive(Clone, Copy)]
struct Valued {
    index: usize,
    value: f64,
}

impl<'m> Quantities<'m> {
    /// Borrows a mesh, and the measures of its triangles at positions before or after a run.
    /// `depths` are those of the vertices, if a quantity needs them.
    pub(crate) fn new(
        file: &'m LoadedMesh,
        measured: &'m Measured<'m>,
        depths: Option<Vec<f64>>,
    ) -> Self {
        Self { file, measured, depths, edges: OnceCell::new(), is_on_boundary: OnceCell::new() }
    }

    /// Returns the edges between two triangles.
    pub(crate) fn edges(&self) -> &[InnerEdge] {
        self.edges.get_or_init(|| self.measured.edges())
    }

    /// Returns the reason for which a triangle keeps an angle of 90 degrees or more; `None` if no reason is known.
    pub(crate) fn why_large(&self, triangle: usize) -> Option<WhyLarge> {
        self.measured.why_large(triangle)
    }

    /// Checks that the mesh has the data for a quantity.
    ///
    /// # Errors
    /// Returns an input error for time steps if no vertex of the file has a positive depth.
    pub(crate) fn check(&self, quantity: Quantity) -> Result<(), CliError> {
        let is_wet = self.depths.iter().flatten().any(|&depth| depth > 0.0);
        match quantity {
            Quantity::TimeStep if !is_wet => {
                let path = self.file.source.path().display();
                let problem = "no vertex has a positive depth, which time-step needs";
                Err(CliError::input(format!("{path}: {problem}")).with_remedy(
                    "docs/quality.md lists the names and signs of depths; if z is data, add --z data",
                ))
            }
            _ => Ok(()),
        }
    }

    /// Checks that the mesh has elements with a quantity of elements. Meshes without edges or vertices inside satisfy each threshold
    /// of edges or vertices.
    ///
    /// # Errors
    /// Returns an input error for a quantity of triangles if the mesh has quadrilaterals alone.
    pub(crate) fn check_elements(&self, quantity: Quantity) -> Result<(), CliError> {
        if quantity.part() != Part::Triangle || !self.elements(quantity, Among::All).is_empty() {
            return Ok(());
        }
        let path = self.file.source.path().display();
        let problem = format!("{path}: no element is a triangle, which {quantity} needs");
        Err(CliError::input(problem).with_remedy("Leave out the threshold"))
    }

    /// Counts the elements, or other parts, with a value in the range of a threshold, and locates the worst part.
    pub(crate) fn finding(&self, threshold: &Threshold) -> Finding {
        self.find(threshold, Among::All)
    }

    /// Does the work of [`finding`](Self::finding) for a limit of a solver, which concerns triangles or quadrilaterals alone.
    pub(crate) fn finding_among(&self, threshold: &Threshold, elements: Elements) -> Finding {
        self.find(threshold, Among::Only(elements))
    }

    /// Counts the triangles or the quadrilaterals of the mesh.
    pub(crate) fn count(&self, elements: Elements) -> usize {
        let topology = self.measured.topology();
        match elements {
            Elements::Triangles => topology.triangles().len(),
            Elements::Quadrilaterals => topology.quadrilaterals().len(),
        }
    }

    /// Returns the range of the visited elements that may have a quantity of elements. Triangles come first.
    fn elements(&self, quantity: Quantity, among: Among) -> Range<usize> {
        let triangles = self.count(Elements::Triangles);
        let all = match quantity {
            Quantity::Measure(measure) => self.measured.count_with(measure),
            Quantity::TimeStep => self.measured.count(),
            _ => triangles,
        };
        match among {
            Among::All => 0..all,
            Among::Only(Elements::Triangles) => 0..triangles,
            Among::Only(Elements::Quadrilaterals) => triangles..all,
        }
    }

    /// Counts the parts beyond a threshold, and locates the worst part.
    fn find(&self, threshold: &Threshold, among: Among) -> Finding {
        let (count, total, worst);
        let quantity = threshold.quantity;
        let is_of_elements = quantity.part() == Part::Triangle;
        let elements = self.elements(quantity, among);
        let is_of_all = elements == self.elements(quantity, Among::All);
        if let Some(measure) = quantity.measure().filter(|_| is_of_elements && is_of_all) {
            // Measures of all elements need no list of values.
            count = self.measured.count_where(measure, |value| threshold.is_met(value)).0;
            total = self.measured.count_with(measure);
            let found = self.measured.worst(measure, 1);
            worst = found.first().map(|&(index, value)| Valued { index, value });
        } else {
            let values = self.values(threshold, among);
            count = values.iter().filter(|part| threshold.is_met(part.value)).count();
            total = values.len();
            let worse = |a: Valued, b: Valued| match threshold.is_worse(b.value, a.value) {
                true => b,
                false => a,
            };
            worst = values.into_iter().reduce(worse);
        }
        let worst = worst.map(|Valued { index, value }| {
            let place = self.place(quantity.part(), index);
            Worst { place, value }
        });
        let has_others = is_of_elements && elements.end > self.count(Elements::Triangles);
        let parts = match among {
            Among::Only(Elements::Quadrilaterals) => Elements::Quadrilaterals.name(),
            _ if has_others => "elements",
            _ => quantity.part().noun(false),
        };
        Finding { threshold: threshold.clone(), parts, count, total, worst }
    }

    /// Returns the values of all parts that have a quantity. Vertices on the boundary have few triangles in every mesh, so
    /// a threshold of small numbers is for vertices inside alone.
    fn values(&self, threshold: &Threshold, among: Among) -> Vec<Valued> {
        let valued = |(index, value)| Valued { index, value };
        let topology = self.measured.topology();
        match threshold.quantity {
            Quantity::Measure(measure) if measure.is_of_edges() => {
                let values = self.edges().iter().map(|edge| edge.value(measure));
                values.enumerate().map(valued).collect()
            }
            Quantity::Measure(measure) => {
                let range = self.elements(threshold.quantity, among);
                let values = self.measured.values(measure).into_iter().enumerate();
                values.take(range.end).skip(range.start).map(valued).collect()
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
            Quantity::TimeStep => {
                let Some(depths) = &self.depths else { return Vec::new() };
                let in_degrees = self.file.chart().is_some() || degrees(self.file).is_some();
                let points = self.measured.points();
                let steps = self.elements(threshold.quantity, among).map(|index| {
                    let corners = self.file.corners(self.measured.element(index));
                    let depth = corners.iter().map(|&v| depths[v as usize]).fold(0.0, f64::max);
                    let corners: Vec<_> = corners.iter().map(|&v| points[v as usize]).collect();
                    (index, least_altitude(&corners, in_degrees) / (GRAVITY * depth).sqrt())
                });
                steps.filter(|(_, step)| step.is_finite()).map(valued).collect()
            }
            Quantity::Neighbors => {
                let is_on_boundary = self.is_on_boundary();
                let is_triangle = |&c: &u32| matches!(topology.element(c), Element::Triangle(_));
                let is_of_triangles = |v: usize| {
                    among == Among::All || topology.star(v as u32).iter().all(is_triangle)
                };
                let is_counted = |&(v, count): &(usize, usize)| {
                    count > 0 && !(threshold.is_below && is_on_boundary[v]) && is_of_triangles(v)
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
            Part::Triangle => Place::of_element(&self.file.source, self.measured.element(index)),
            Part::Vertex | Part::Hole => Place::Vertex(self.file.vertex_place(index as u32)),
            Part::Edge => {
                let mut ends = self.edges()[index].vertices.map(|v| self.file.vertex_place(v));
                ends.sort_by_key(|end| end.id);
                Place::Edge(ends)
            }
        }
    }
}

/// Acceleration of gravity, in m/s².
const GRAVITY: f64 = 9.81;

/// Length of a degree of latitude in meters, on a sphere of the Earth's mean radius of 6,371 km.
const DEGREE: f64 = 6_371_000.0 * PI / 180.0;

/// Returns the least altitude of a triangle, or of the four corner triangles of a quadrilateral, as [`altitude`] does.
fn least_altitude(corners: &[[f64; 2]], in_degrees: bool) -> f64 {
    let count = corners.len();
    let of_corner = |k: usize| {
        let [before, after] = [(k + count - 1) % count, (k + 1) % count];
        altitude([corners[before], corners[k], corners[after]], in_degrees)
    };
    // Each corner triangle of a triangle is the triangle itself.
    let triangles = if count == 3 { 1..2 } else { 0..count };
    triangles.map(of_corner).fold(f64::INFINITY, f64::min)
}

/// Returns the least altitude of a triangle in the unit of its corners, without a sign; in meters if the corners are
/// longitudes and latitudes in degrees.
fn altitude(corners: [[f64; 2]; 3], in_degrees: bool) -> f64 {
    let latitude = corners.iter().map(|corner| corner[1] / 3.0).sum::<f64>();
    let lengths =
        if in_degrees { [DEGREE * latitude.to_radians().cos(), DEGREE] } else { [1.0; 2] };
    let [p, q, r] = corners;
    let to = |from: [f64; 2], to: [f64; 2]| [0, 1].map(|i| (to[i] - from[i]) * lengths[i]);
    let [u, v, w] = [to(p, q), to(p, r), to(q, r)];
    let longest = [u, v, w].map(|[x, y]| x.hypot(y)).into_iter().fold(0.0, f64::max);
    (u[0] * v[1] - u[1] * v[0]).abs() / longest
}

impl Finding {
    /// Returns a sentence with the number of violations and the place of the worst value. Values have no sign for degrees
    /// if `is_plain` is true.
    pub(crate) fn sentence(&self, is_plain: bool) -> String {
        let Self { threshold, parts, count, total, worst } = self;
        let counted = match count {
            0 => format!("none of {total} {parts} has {threshold}"),
            count => format!("{count} of {total} {parts} have {threshold}"),
        };
        match worst {
            None => counted,
            Some(worst) => {
                format!("{counted}; the worst is {}", worst.described(threshold.quantity, is_plain))
            }
        }
    }

    /// Returns a sentence on the worst value of all. Values have no sign for degrees if `is_plain` is true.
    pub(crate) fn worst_of_all(&self, is_plain: bool) -> String {
        let quantity = self.threshold.quantity;
        let Some(worst) = &self.worst else { return String::new() };
        let (total, parts) = (self.total, self.parts);
        format!("the worst of {total} {parts} is {}", worst.described(quantity, is_plain))
    }
}

impl Worst {
    fn described(&self, quantity: Quantity, is_plain: bool) -> String {
        let value = written(quantity, self.value);
        let unit = match (quantity.unit(), is_plain) {
            ("°", true) => " deg",
            (unit, _) => unit,
        };
        format!("{}, {quantity} {value}{unit}", self.place)
    }
}

/// Formats a value of a quantity in at most eight characters.
pub(crate) fn written(quantity: Quantity, value: f64) -> String {
    if quantity.is_count() { format!("{value}") } else { fit8(value) }
}
