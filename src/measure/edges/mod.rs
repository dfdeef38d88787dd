//! Measures of the edges between two triangles, by which solvers with unknowns at circumcenters judge meshes.

use crate::measure::neighbors::for_each_across;
use crate::parallel::{collect, map_ranges};
use crate::targets::Surface;
use crate::topology::Topology;

/// Number of triangles whose edges one task measures.
const CHUNK: usize = 1 << 12;

/// An edge between two triangles, with measures by the definitions of MeshKernel 8 (Deltares: MeshFaceCenters.cpp,
/// MeshOrthogonality.cpp, MeshSmoothness.cpp and Mesh2D.cpp).
///
/// The center of a triangle is its circumcenter if the circumcenter is inside, by coordinates. Otherwise, the center is
/// the place where the segment from the mean of the corners to the circumcenter leaves the triangle. A triangle without
/// neighbors has the mean of its corners as center. In degrees, a difference of longitudes is multiplied by the cosine of
/// the mean latitude of its two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct InnerEdge {
    /// The ends of the edge.
    pub vertices: [u32; 2],
    /// The indices of the two triangles, ascending.
    pub triangles: [u32; 2],
    /// |cos| of the angle between the edge and the segment between the centers of its triangles, from 0 (orthogonal) to
    /// 1. 0 if both centers coincide, where MeshKernel has no value.
    pub orthogonality: f64,
    /// Distance between the two centers, divided by the mean of the roots of both areas; 0.877 between equilateral
    /// triangles. D-Flow FM calls edges below 0.1 small flow links.
    pub flow_link: f64,
    /// The larger of both areas divided by the smaller; infinite if a triangle is flat.
    pub smoothness: f64,
}

/// `flow_link` of an edge between equilateral triangles, 2 / 3^(3/4).
pub(crate) const EQUILATERAL: f64 = 0.877_382_675_301_661_6;

/// The worst values of the edges of a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct WorstEdges {
    /// Largest [`InnerEdge::orthogonality`]; 0 without neighbors.
    pub(crate) orthogonality: f64,
    /// Least [`InnerEdge::flow_link`]; that of equilateral triangles without neighbors.
    pub(crate) flow_link: f64,
}

/// The center and the area of a triangle.
#[derive(Clone, Copy, Default)]
struct Cell {
    /// The first corner, and the offset of the center from that corner, in coordinates. The sum would round.
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

/// Returns whether a point is inside a triangle or on its boundary, by the signs of products of coordinates.
fn is_inside(triangle: [[f64; 2]; 3], point: [f64; 2]) -> bool {
    let side = |k: usize| {
        let from = triangle[k];
        cross(minus(triangle[(k + 1) % 3], from), minus(point, from))
    };
    let sides = [side(0), side(1), side(2)];
    sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0)
}

impl Cell {
    /// Returns the cell of a triangle with corners at `points`.
    fn of(surface: Surface, points: [[f64; 2]; 3], has_neighbors: bool) -> Self {
        let [first, ..] = points;
        let at = points.map(|point| minus(point, first));
        // The vector from one offset to another.
        let between = |from: [f64; 2], to: [f64; 2]| {
            vector(surface, minus(to, from), first[1] + 0.5 * (from[1] + to[1]))
        };
        let mean = [0, 1].map(|axis| (at[1][axis] + at[2][axis]) / 3.0);
        let (u, v) = (between(at[0], at[1]), between(at[0], at[2]));
        let area = match surface {
            Surface::Plane => 0.5 * cross(u, v).abs(),
            Surface::Sphere => {
                let corner = |axis: usize| at.iter().fold(f64::INFINITY, |m, p| m.min(p[axis]));
                let corner = [corner(0), corner(1)];
                let side = |k: usize| {
                    let (from, to) = (at[k], at[(k + 1) % 3]);
                    let [a, b] = [from, to].map(|end| between(corner, end));
                    let [dx, dy] = between(from, to);
                    0.25 * (dy * (a[0] + b[0]) - dx * (a[1] + b[1]))
                };
                (side(0) + side(1) + side(2)).abs()
            }
        };
        let mut center = mean;
        if has_neighbors {
            let doubled = -cross(u, v);
            let z = if doubled == 0.0 { 0.0 } else { dot(u, minus(u, v)) / doubled };
            let [x, y] = surface.lengths(first[1] + mean[1]);
            center = [0.5 * (v[0] - z * v[1]) / x, 0.5 * (v[1] + z * v[0]) / y];
            let out = between(mean, center);
            // In degrees, the segment to a center that is barely inside seems to leave the triangle, as each difference of
            // longitudes has a factor of its own.
            let sides = if is_inside(at, center) { 0..0 } else { 0..3 };
            for k in sides {
                let (from, to) = (at[k], at[(k + 1) % 3]);
                let (side, start) = (between(from, to), between(mean, from));
                let across = cross(out, side);
                let (along, share) = (cross(start, side) / across, cross(start, out) / across);
                if (0.0..=1.0).contains(&along) && (0.0..=1.0).contains(&share) {
                    center = [0, 1].map(|axis| mean[axis] + along * (center[axis] - mean[axis]));
                    break;
                }
            }
        }
        Self { corner: first, center, area }
    }
}

/// The cells of all triangles of a mesh.
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
        let cells = collect(triangles.len(), |t| {
            let mut has_neighbors = false;
            for_each_side(topology, t, |_, _| has_neighbors = true);
            Cell::of(surface, triangles[t].map(|v| points[v as usize]), has_neighbors)
        });
        Self { surface, points, cells }
    }

    /// Returns the edge between two triangles, given its ends.
    fn edge(&self, vertices: [u32; 2], triangles: [usize; 2]) -> InnerEdge {
        let [p, q] = vertices.map(|v| self.points[v as usize]);
        let side = vector(self.surface, minus(q, p), 0.5 * (p[1] + q[1]));
        let [one, two] = triangles.map(|t| self.cells[t]);
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
            triangles: triangles.map(|t| t as u32),
            // Also NaN for an edge without length.
            orthogonality: if cosine.is_nan() { 0.0 } else { cosine.min(1.0) },
            flow_link: if roots > 0.0 { length / roots } else { 0.0 },
            smoothness: if ratio.is_nan() { f64::INFINITY } else { ratio },
        }
    }
}

/// Calls `visit` with the ends of each edge of triangle `t`, and with the triangle across the edge.
fn for_each_side(topology: &Topology<'_>, t: usize, mut visit: impl FnMut([u32; 2], usize)) {
    let corners = topology.triangles()[t];
    for k in 0..3 {
        let ends = [corners[k], corners[(k + 1) % 3]];
        for_each_across(topology, t, ends, |other| visit(ends, other));
    }
}

/// Returns the worst values of the edges of each triangle.
pub(crate) fn worst_edges(
    surface: Surface,
    points: &[[f64; 2]],
    topology: &Topology<'_>,
) -> Vec<WorstEdges> {
    let cells = Cells::new(surface, points, topology);
    collect(topology.triangles().len(), |t| {
        let mut worst = WorstEdges { orthogonality: 0.0, flow_link: f64::INFINITY };
        for_each_side(topology, t, |ends, other| {
            // The same order of the triangles on both sides gives the same bits.
            let edge = cells.edge(ends, [t.min(other), t.max(other)]);
            worst.orthogonality = worst.orthogonality.max(edge.orthogonality);
            worst.flow_link = worst.flow_link.min(edge.flow_link);
        });
        let flow_link = if worst.flow_link < f64::INFINITY { worst.flow_link } else { EQUILATERAL };
        WorstEdges { flow_link, ..worst }
    })
}

/// Returns the edges between two triangles, in the order of the triangle with the smaller index.
pub(crate) fn inner_edges(
    surface: Surface,
    points: &[[f64; 2]],
    topology: &Topology<'_>,
) -> Vec<InnerEdge> {
    let cells = &Cells::new(surface, points, topology);
    map_ranges(topology.triangles().len(), CHUNK, |range| {
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
