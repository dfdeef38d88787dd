//! The spacing at walls: the distances from a wall of the vertices next to it, before and after a run.

use std::collections::HashMap;

use crate::error::MeshError;
use crate::layers::elements::Elements;
use crate::layers::sectors::NONE;
use crate::layers::vector::{cross, distance_to_segment, dot, length, median, minus};
use crate::parallel::counting_sort::Groups;

/// Ratio of an edge of the wall to the distance from which a vertex counts as one with flat triangles.
const FLAT: f64 = 2.0;

/// Share of change from which a distance counts as changed.
const CHANGED: f64 = 0.1;

/// The distances of vertices from the wall next to them, before and after a run. Vertex-centered solvers of flows compute
/// y+ from these distances.
///
/// The vertex next to a vertex of the wall is the inner neighbor whose edge is the most normal to the wall in the mesh before
/// the run. Distances are those from the edges of the wall that are up to two edges away. Both ends of
/// a wall are left out. Vertices of a wall inside the mesh have a distance on each side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spacing {
    /// Number of distances.
    pub count: usize,
    /// Number of distances of at most half of the mean length of the two edges of the wall, before the run.
    pub flat: usize,
    /// Median distances before and after, in the unit of the mesh.
    pub medians: [f64; 2],
    /// Least, median and greatest ratio of a distance after the run to that before.
    pub ratios: [f64; 3],
    /// Share of the distances that change by more than 10 %, from 0 to 1.
    pub changed: f64,
}

impl Spacing {
    /// Returns the largest factor by which a distance grows or shrinks, at least 1.
    pub fn largest_change(&self) -> f64 {
        self.ratios[2].max(1.0 / self.ratios[0])
    }

    /// Returns whether triangles at half of the vertices of the wall are flat, as in a boundary layer.
    pub fn is_flat(&self) -> bool {
        2 * self.flat >= self.count
    }
}

impl Elements<'_> {
    /// Returns the spacing at each of the `walls`, which are lists of edges, when vertices move to the points `after`. `None`
    /// for a wall without a vertex that counts.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` or `after` do not have one entry per vertex, [`MeshError::IndexOutOfRange`] if
    /// `faces`, `lines` or `walls` name a vertex that does not exist.
    pub fn spacing(
        &self,
        walls: &[Vec<[u32; 2]>],
        after: &[[f64; 2]],
    ) -> Result<Vec<Option<Spacing>>, MeshError> {
        let named: Vec<u32> = walls.iter().flat_map(|wall| wall.as_flattened()).copied().collect();
        self.check(Some(&named))?;
        self.topology.check_count(after)?;
        let inner = InnerNeighbors::new(self, &named);
        Ok(walls.iter().map(|wall| of_wall(self.points, after, wall, &inner)).collect())
    }
}

/// Neighbors, inside the mesh, of the vertices of walls.
struct InnerNeighbors {
    /// Row of each vertex in `neighbors`; [`NONE`] for vertices of no wall.
    row: Vec<u32>,
    neighbors: Vec<Vec<u32>>,
}

impl InnerNeighbors {
    fn new(elements: &Elements<'_>, walls: &[u32]) -> Self {
        let mut row = vec![NONE; elements.points.len()];
        let mut count = 0;
        for &v in walls {
            let row = &mut row[v as usize];
            if *row == NONE {
                *row = count;
                count += 1;
            }
        }
        let mut inner = Self { row, neighbors: vec![Vec::new(); count as usize] };
        let is_boundary = boundary(elements);
        // Most triangles have no vertex on a wall.
        for t in elements.topology.triangles() {
            let [a, b, c] = t.map(|v| inner.row[v as usize]);
            if a & b & c != NONE {
                inner.add(t, &is_boundary);
            }
        }
        for face in elements.all_faces().iter() {
            inner.add(face, &is_boundary);
        }
        for list in &mut inner.neighbors {
            list.sort_unstable();
            list.dedup();
        }
        inner
    }

    /// Adds the neighbors along the edges of an element.
    fn add(&mut self, element: &[u32], is_boundary: &[bool]) {
        for i in 0..element.len() {
            let ends = [element[i], element[(i + 1) % element.len()]];
            for [from, to] in [ends, [ends[1], ends[0]]] {
                let row = self.row[from as usize];
                if row != NONE && !is_boundary[to as usize] {
                    self.neighbors[row as usize].push(to);
                }
            }
        }
    }

    fn of(&self, vertex: u32) -> &[u32] {
        let row = self.row.get(vertex as usize).copied().unwrap_or(NONE);
        self.neighbors.get(row as usize).map_or(&[], Vec::as_slice)
    }
}

/// Returns whether each vertex is on an edge that one element has.
fn boundary(elements: &Elements<'_>) -> Vec<bool> {
    let mut is_boundary = vec![false; elements.points.len()];
    let of_triangles = elements.topology.boundary_edges();
    let mut uses: HashMap<[u32; 2], u32> = HashMap::new();
    let around = |face: &Vec<u32>| {
        let ends = |i: usize| [face[i], face[(i + 1) % face.len()]];
        (0..face.len()).map(ends).collect::<Vec<_>>()
    };
    let of_faces = elements.faces.iter().flat_map(around);
    if elements.faces.is_empty() {
        of_triangles.as_flattened().iter().for_each(|&v| is_boundary[v as usize] = true);
        return is_boundary;
    }
    for [a, b] in of_triangles.iter().copied().chain(of_faces) {
        *uses.entry([a.min(b), a.max(b)]).or_default() += 1;
    }
    for (edge, _) in uses.iter().filter(|(_, count)| **count == 1) {
        edge.iter().for_each(|&v| is_boundary[v as usize] = true);
    }
    is_boundary
}

/// Returns the spacing at one wall.
fn of_wall(
    before: &[[f64; 2]],
    after: &[[f64; 2]],
    wall: &[[u32; 2]],
    inner: &InnerNeighbors,
) -> Option<Spacing> {
    let chain = Chain::new(wall);
    let (mut distances, mut flat) = ([Vec::new(), Vec::new()], 0);
    for v in 0..chain.vertices.len() {
        let &[a, b] = chain.beside(v) else { continue };
        for next in most_normal(before, [a, chain.vertices[v], b], inner) {
            let near = chain.near(v);
            let [old, new] = [before, after].map(|points| {
                let to = |[p, q]: [u32; 2]| {
                    let [next, p, q] = [next, p, q].map(|v| points[v as usize]);
                    distance_to_segment(next, [p, q])
                };
                near.iter().copied().map(to).fold(f64::INFINITY, f64::min)
            });
            if old > 0.0 && new.is_finite() {
                let edge = |to: u32| {
                    length(minus(before[to as usize], before[chain.vertices[v] as usize]))
                };
                flat += usize::from(0.5 * (edge(a) + edge(b)) >= FLAT * old);
                distances[0].push(old);
                distances[1].push(new);
            }
        }
    }
    let [old, new] = &distances;
    let ratios: Vec<f64> = old.iter().zip(new).map(|(old, new)| new / old).collect();
    let count = ratios.len();
    let is_changed = |ratio: &&f64| (**ratio - 1.0).abs() > CHANGED;
    let changed = ratios.iter().filter(is_changed).count() as f64 / count as f64;
    let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = ratios.iter().copied().fold(0.0, f64::max);
    let ratios = [least, median(ratios)?, greatest];
    let [old, new] = distances;
    Some(Spacing { count, flat, medians: [median(old)?, median(new)?], ratios, changed })
}

/// Returns the inner neighbors of a wall's vertex, at most one on each side of the wall, whose edges are the most normal.
/// `along` is the vertex between its two neighbors on the wall.
fn most_normal(points: &[[f64; 2]], along: [u32; 3], inner: &InnerNeighbors) -> Vec<u32> {
    let [p, q, r] = along.map(|v| points[v as usize]);
    let unit = |a: [f64; 2]| a.map(|x| x / length(a).max(f64::MIN_POSITIVE));
    let [first, second] = [unit(minus(q, p)), unit(minus(r, q))];
    let normal = unit([-(first[1] + second[1]), first[0] + second[0]]);
    let mut best: [Option<(f64, u32)>; 2] = [None; 2];
    for &to in inner.of(along[1]) {
        let edge = minus(points[to as usize], q);
        let cosine = dot(unit(edge), normal);
        // Around a sharp edge, both sides of the wall are sides of the normal.
        let is_left = match cross(first, second) >= 0.0 {
            true => cross(first, edge) > 0.0 && cross(second, edge) > 0.0,
            false => cross(first, edge) > 0.0 || cross(second, edge) > 0.0,
        };
        let side = &mut best[usize::from(!is_left)];
        if side.is_none_or(|(largest, _)| cosine.abs() > largest) {
            *side = Some((cosine.abs(), to));
        }
    }
    best.into_iter().flatten().map(|(_, to)| to).collect()
}

/// The edges at each vertex of a wall.
struct Chain<'w> {
    wall: &'w [[u32; 2]],
    /// Vertices of the wall, ascending.
    vertices: Vec<u32>,
    edges: Groups,
    beside: Vec<Vec<u32>>,
}

impl<'w> Chain<'w> {
    fn new(wall: &'w [[u32; 2]]) -> Self {
        let mut vertices = wall.as_flattened().to_vec();
        vertices.sort_unstable();
        vertices.dedup();
        let row = |v: u32| vertices.binary_search(&v).unwrap_or(0) as u32;
        let edges = Groups::new(wall.len(), vertices.len(), |e| wall[e].map(row));
        let other = |v: usize, e: u32| {
            let [a, b] = wall[e as usize];
            if a == vertices[v] { b } else { a }
        };
        let beside = |v: usize| {
            let mut list: Vec<u32> = edges.of(v).iter().map(|&e| other(v, e)).collect();
            list.sort_unstable();
            list.dedup();
            list
        };
        let beside = (0..vertices.len()).map(beside).collect();
        Self { wall, vertices, edges, beside }
    }

    /// Returns the neighbors of a vertex along the wall.
    fn beside(&self, row: usize) -> &[u32] {
        &self.beside[row]
    }

    /// Returns the edges of the wall that are up to two edges away from a vertex.
    fn near(&self, row: usize) -> Vec<[u32; 2]> {
        let beside = self.beside[row].iter().filter_map(|v| self.vertices.binary_search(v).ok());
        let rows = std::iter::once(row).chain(beside);
        rows.flat_map(|row| self.edges.of(row)).map(|&e| self.wall[e as usize]).collect()
    }
}
