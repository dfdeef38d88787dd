//! Measures of the edges between two elements, by which solvers with unknowns at circumcenters judge meshes.

use crate::measure::neighbors::for_each_side;
use crate::parallel::{collect, map_ranges};
use crate::targets::Surface;
use crate::topology::Topology;

/// Number of elements whose edges one task measures.
const CHUNK: usize = 1 << 12;

/// An edge between two elements, with measures by the definitions of MeshKernel 8 (Deltares: MeshFaceCenters.cpp,
/// MeshOrthogonality.cpp, MeshSmoothness.cpp and Mesh2D.cpp).
///
/// The center of a triangle is its circumcenter if the circumcenter is inside, by coordinates. Otherwise, the center is
/// the place where the segment from the mean of the corners to the circumcenter leaves the triangle. A triangle without
/// neighbors has the mean of its corners as center. In degrees, a difference of longitudes is multiplied by the cosine of
/// the mean latitude of its two ends.
///
/// In place of the circumcenter, a quadrilateral has a point near the perpendicular bisectors of its edges with neighbors: the
/// result of 100 steps from the mean of the vertices, each by a tenth of the ways to all bisectors. The point is the
/// circumcenter if the vertices are on a circle. A quadrilateral with fewer than two edges with neighbors has the mean of its
/// vertices as center.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct InnerEdge {
    /// The ends of the edge.
    pub vertices: [u32; 2],
    /// The numbers of the two elements, ascending, as in [`Measured`](crate::measure::Measured).
    pub elements: [u32; 2],
    /// |cos| of the angle between the edge and the segment between the centers of its elements, from 0 (orthogonal) to
    /// 1. 0 if both centers coincide, where MeshKernel has no value.
    pub orthogonality: f64,
    /// Distance between the two centers, divided by the mean of the roots of both areas; 0.877 between equilateral
    /// triangles. D-Flow FM calls edges below 0.1 small flow links.
    pub flow_link: f64,
    /// The larger of both areas divided by the smaller; infinite if an element is flat.
    pub smoothness: f64,
}

/// `flow_link` of an edge between equilateral triangles, 2 / 3^(3/4).
pub(crate) const EQUILATERAL: f64 = 0.877_382_675_301_661_6;
/// `flow_link` of an edge between squares.
pub(crate) const SQUARE: f64 = 1.0;

/// The worst values of the edges of an element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct WorstEdges {
    /// Largest [`InnerEdge::orthogonality`]; 0 without neighbors.
    pub(crate) orthogonality: f64,
    /// Least [`InnerEdge::flow_link`]; that of equilateral triangles or of squares without neighbors.
    pub(crate) flow_link: f64,
    /// Largest [`InnerEdge::smoothness`]; 1 without neighbors.
    pub(crate) smoothness: f64,
}

/// The center and the area of an element.
#[derive(Clone, Copy, Default)]
struct Cell {
    /// The first vertex, and the offset of the center from that vertex, in coordinates. The sum would round.
    corner: [f64; 2],
    center: [f64; 2],
    area: f64,
}

fn dot(u: [f64; 2], v: [f64; 2]) -> f64 {
    u[0] * v[0] + u[1] * v[1]
}

fn cross(u: [f64; 2], v: [f64; 2]) -> f64 {
    u[0] * v[1] - u[1] * v[0]
}

fn minus(p: [f64; 2], q: [f64; 2]) -> [f64; 2] {
    [p[0] - q[0], p[1] - q[1]]
}

/// Returns the vector of an offset between two points with the mean latitude `y`, in the unit of the second coordinate.
fn vector(surface: Surface, offset: [f64; 2], y: f64) -> [f64; 2] {
    let [x, y] = surface.lengths(y);
    [offset[0] * x, offset[1] * y]
}

/// Returns whether a point is inside a convex polygon or on its boundary, by the signs of products of coordinates.
fn is_inside<const N: usize>(polygon: [[f64; 2]; N], point: [f64; 2]) -> bool {
    let side = |k: usize| {
        let from = polygon[k];
        cross(minus(polygon[(k + 1) % N], from), minus(point, from))
    };
    let sides: [f64; N] = std::array::from_fn(side);
    sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0)
}

impl Cell {
    /// Returns the cell of a triangle with corners at `points`.
    fn of_triangle(surface: Surface, points: [[f64; 2]; 3], has_neighbors: bool) -> Self {
        let polygon = Polygon::new(surface, points);
        let at = polygon.at;
        let mean = [0, 1].map(|axis| (at[1][axis] + at[2][axis]) / 3.0);
        let (u, v) = (polygon.between(at[0], at[1]), polygon.between(at[0], at[2]));
        let area = match surface {
            Surface::Plane => 0.5 * cross(u, v).abs(),
            Surface::Sphere => polygon.area_in_degrees(),
        };
        let mut center = mean;
        if has_neighbors {
            let doubled = -cross(u, v);
            let z = if doubled == 0.0 { 0.0 } else { dot(u, minus(u, v)) / doubled };
            let [x, y] = surface.lengths(polygon.first[1] + mean[1]);
            let found = [0.5 * (v[0] - z * v[1]) / x, 0.5 * (v[1] + z * v[0]) / y];
            center = polygon.kept_inside(mean, found);
        }
        Self { corner: polygon.first, center, area }
    }

    /// Returns the cell of a quadrilateral with vertices at `points`. `is_inner` tells which edges, from each vertex to the next,
    /// have a neighbor.
    fn of_quadrilateral(surface: Surface, points: [[f64; 2]; 4], is_inner: [bool; 4]) -> Self {
        let polygon = Polygon::new(surface, points);
        let at = polygon.at;
        let mean = [0, 1].map(|axis| (at[1][axis] + at[2][axis] + at[3][axis]) / 4.0);
        let area = match surface {
            Surface::Plane => 0.5 * cross(minus(at[2], at[0]), minus(at[3], at[1])).abs(),
            Surface::Sphere => polygon.area_in_degrees(),
        };
        let mut center = mean;
        if is_inner.iter().filter(|&&is_inner| is_inner).count() > 1 {
            let lengths = surface.lengths(polygon.first[1] + mean[1]);
            let from_mean = |p: [f64; 2]| [0, 1].map(|axis| (p[axis] - mean[axis]) * lengths[axis]);
            // A step takes x to x + 0.1 Σ (m - x·t) t, with t the directions of the edges and m the places of their middles.
            let (mut step, mut toward) = ([[1.0, 0.0], [0.0, 1.0]], [0.0; 2]);
            for k in (0..4).filter(|&k| is_inner[k]) {
                let [from, to] = [at[k], at[(k + 1) % 4]].map(from_mean);
                let side = minus(to, from);
                let length = side[0].hypot(side[1]);
                let t = side.map(|x| x / length);
                let middle = 0.5 * (dot(from, t) + dot(to, t));
                for i in 0..2 {
                    step[0][i] -= TOWARD_BISECTORS * t[0] * t[i];
                    step[1][i] -= TOWARD_BISECTORS * t[1] * t[i];
                    toward[i] += TOWARD_BISECTORS * middle * t[i];
                }
            }
            let sum = sum_of_powers(step, STEPS_TO_CENTER);
            let found = sum.map(|row| dot(row, toward));
            if found.iter().all(|x| x.is_finite()) {
                let found = [0, 1].map(|axis| mean[axis] + found[axis] / lengths[axis]);
                center = polygon.kept_inside(mean, found);
            }
        }
        Self { corner: polygon.first, center, area }
    }
}

/// Share of the ways to the perpendicular bisectors that a step to the center of a quadrilateral goes.
const TOWARD_BISECTORS: f64 = 0.1;
/// Number of steps to the center of a quadrilateral.
const STEPS_TO_CENTER: u32 = 100;

/// Returns I + A + A² + ... with `count` terms, for a symmetric matrix A.
fn sum_of_powers(a: [[f64; 2]; 2], count: u32) -> [[f64; 2]; 2] {
    const ONE: [[f64; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];
    // Powers of a symmetric matrix are symmetric, and all products are of powers.
    let times = |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| a.map(|row| b.map(|column| dot(row, column)));
    let plus =
        |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| [0, 1].map(|i| [a[i][0] + b[i][0], a[i][1] + b[i][1]]);
    let (mut sum, mut power) = ([[0.0; 2]; 2], ONE);
    for bit in (0..u32::BITS - count.leading_zeros()).rev() {
        sum = plus(sum, times(power, sum));
        power = times(power, power);
        if count >> bit & 1 == 1 {
            sum = plus(ONE, times(a, sum));
            power = times(power, a);
        }
    }
    sum
}

/// The vertices of an element, relative to the first.
struct Polygon<const N: usize> {
    surface: Surface,
    first: [f64; 2],
    at: [[f64; 2]; N],
}

impl<const N: usize> Polygon<N> {
    fn new(surface: Surface, points: [[f64; 2]; N]) -> Self {
        let first = points[0];
        Self { surface, first, at: points.map(|point| minus(point, first)) }
    }

    /// Returns the vector from one offset to another.
    fn between(&self, from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
        vector(self.surface, minus(to, from), self.first[1] + 0.5 * (from[1] + to[1]))
    }

    /// Returns the area as MeshKernel computes it in degrees, by the contributions of the edges.
    fn area_in_degrees(&self) -> f64 {
        let corner = |axis: usize| self.at.iter().fold(f64::INFINITY, |m, p| m.min(p[axis]));
        let corner = [corner(0), corner(1)];
        let side = |k: usize| {
            let (from, to) = (self.at[k], self.at[(k + 1) % N]);
            let [a, b] = [from, to].map(|end| self.between(corner, end));
            let [dx, dy] = self.between(from, to);
            0.25 * (dy * (a[0] + b[0]) - dx * (a[1] + b[1]))
        };
        (0..N).map(side).sum::<f64>().abs()
    }

    /// Returns a center, or the place where the segment from the mean of the vertices to the center leaves the element.
    fn kept_inside(&self, mean: [f64; 2], center: [f64; 2]) -> [f64; 2] {
        let out = self.between(mean, center);
        // In degrees, the segment to a center that is barely inside seems to leave the element, as each difference of
        // longitudes has a factor of its own.
        let sides = if is_inside(self.at, center) { 0..0 } else { 0..N };
        for k in sides {
            let (from, to) = (self.at[k], self.at[(k + 1) % N]);
            let (side, start) = (self.between(from, to), self.between(mean, from));
            let across = cross(out, side);
            let (along, share) = (cross(start, side) / across, cross(start, out) / across);
            if (0.0..=1.0).contains(&along) && (0.0..=1.0).contains(&share) {
                return [0, 1].map(|axis| mean[axis] + along * (center[axis] - mean[axis]));
            }
        }
        center
    }
}

/// The cells of all elements of a mesh.
struct Cells<'c> {
    surface: Surface,
    points: &'c [[f64; 2]],
    cells: Vec<Cell>,
}

impl<'c> Cells<'c> {
    fn new(surface: Surface, points: &'c [[f64; 2]], topology: &Topology<'_>) -> Self {
        // If stars have been dropped, this line computes them again before several threads need them.
        topology.star(0);
        let triangles = topology.triangles();
        let cells = collect(topology.element_count(), |element| {
            if let Some(corners) = triangles.get(element) {
                let mut has_neighbors = false;
                for_each_side(topology, element, |_, _| has_neighbors = true);
                let points = corners.map(|v| points[v as usize]);
                return Cell::of_triangle(surface, points, has_neighbors);
            }
            let corners = topology.corner_list().quadrilateral(element - triangles.len());
            let mut is_inner = [false; 4];
            for_each_side(topology, element, |[from, _], _| {
                for k in (0..4).filter(|&k| corners[k] == from) {
                    is_inner[k] = true;
                }
            });
            Cell::of_quadrilateral(surface, corners.map(|v| points[v as usize]), is_inner)
        });
        Self { surface, points, cells }
    }

    /// Returns the edge between two elements, given its ends.
    fn edge(&self, vertices: [u32; 2], elements: [usize; 2]) -> InnerEdge {
        let [p, q] = vertices.map(|v| self.points[v as usize]);
        let side = vector(self.surface, minus(q, p), 0.5 * (p[1] + q[1]));
        let [one, two] = elements.map(|element| self.cells[element]);
        let (corners, centers) = (minus(two.corner, one.corner), minus(two.center, one.center));
        let y = 0.5 * (one.corner[1] + one.center[1] + two.corner[1] + two.center[1]);
        let offset = [corners[0] + centers[0], corners[1] + centers[1]];
        let link = vector(self.surface, offset, y);
        let length = link[0].hypot(link[1]);
        let cosine = (dot(link, side) / (length * side[0].hypot(side[1]))).abs();
        let roots = 0.5 * (one.area.sqrt() + two.area.sqrt());
        let ratio = one.area.max(two.area) / one.area.min(two.area);
        InnerEdge {
            vertices,
            elements: elements.map(|element| element as u32),
            // Also NaN for an edge without length.
            orthogonality: if cosine.is_nan() { 0.0 } else { cosine.min(1.0) },
            flow_link: if roots > 0.0 { length / roots } else { 0.0 },
            smoothness: if ratio.is_nan() { f64::INFINITY } else { ratio },
        }
    }
}

/// Returns the worst values of the edges of each element.
pub(crate) fn worst_edges(
    surface: Surface,
    points: &[[f64; 2]],
    topology: &Topology<'_>,
) -> Vec<WorstEdges> {
    let cells = Cells::new(surface, points, topology);
    collect(topology.element_count(), |t| {
        let mut worst =
            WorstEdges { orthogonality: 0.0, flow_link: f64::INFINITY, smoothness: 1.0 };
        for_each_side(topology, t, |ends, other| {
            // The same order of the elements on both sides gives the same bits.
            let edge = cells.edge(ends, [t.min(other), t.max(other)]);
            worst.orthogonality = worst.orthogonality.max(edge.orthogonality);
            worst.flow_link = worst.flow_link.min(edge.flow_link);
            worst.smoothness = worst.smoothness.max(edge.smoothness);
        });
        let ideal = if t < topology.triangles().len() { EQUILATERAL } else { SQUARE };
        let flow_link = if worst.flow_link < f64::INFINITY { worst.flow_link } else { ideal };
        WorstEdges { flow_link, ..worst }
    })
}

/// Returns the edges between two elements, in the order of the element with the smaller number.
pub(crate) fn inner_edges(
    surface: Surface,
    points: &[[f64; 2]],
    topology: &Topology<'_>,
) -> Vec<InnerEdge> {
    let cells = &Cells::new(surface, points, topology);
    map_ranges(topology.element_count(), CHUNK, |range| {
        let mut edges = Vec::new();
        for t in range {
            for_each_side(topology, t, |ends, other| {
                if t < other {
                    edges.push(cells.edge(ends, [t, other]));
                }
            });
        }
        edges
    })
    .concat()
}

#[cfg(test)]
mod tests;
