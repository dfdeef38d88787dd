//! The pieces into which held vertices divide a mesh, and the boundaries of each piece.

use std::collections::{BTreeMap, HashSet};

use crate::layout::Problem;

/// Marks an edge without a triangle across, and a triangle without a piece.
const NONE: u32 = u32::MAX;

/// A corner of the boundary of a piece.
pub(super) struct Corner {
    pub(super) vertex: u32,
    /// Neighbors of the vertex inside the piece, between the boundary edges before and after the vertex. No such
    /// neighbor is held.
    pub(super) inside: Vec<u32>,
}

/// A closed boundary of a piece, with the piece on its left. A vertex occurs once for each time that the boundary
/// passes it. A held vertex without a held edge is a boundary of one corner.
pub(super) type Boundary = Vec<Corner>;

/// A mesh whose held vertices divide it: edges with two held ends separate pieces.
pub(super) struct Pieces<'p> {
    problem: &'p Problem,
    /// For each half-edge, the opposite half-edge in the triangle across, or `NONE`. Half-edge 3 t + i of triangle t
    /// runs from corner i of the triangle to the next corner.
    across: Vec<u32>,
    held: Vec<bool>,
    /// Index of the piece to which the latest search assigned each triangle, or `NONE`.
    piece_of: Vec<u32>,
    /// Number of pieces found in all searches, which is the index of the next piece.
    count: u32,
}

impl<'p> Pieces<'p> {
    /// Creates the pieces with all fixed vertices held.
    pub(super) fn new(problem: &'p Problem) -> Self {
        let free = problem.free_count();
        Self {
            problem,
            across: across(problem.triangles()),
            held: (0..problem.positions().len()).map(|v| v >= free).collect(),
            piece_of: vec![NONE; problem.triangles().len()],
            count: 0,
        }
    }

    pub(super) fn hold(&mut self, vertex: u32) {
        self.held[vertex as usize] = true;
    }

    #[inline]
    pub(super) fn is_held(&self, vertex: u32) -> bool {
        self.held[vertex as usize]
    }

    /// Returns for each vertex whether cuts or the problem hold it.
    pub(super) fn into_held(self) -> Vec<bool> {
        self.held
    }

    /// Returns the vertices of a piece that are not held. A vertex occurs once for each triangle of the piece around
    /// it.
    pub(super) fn inside<'a>(&'a self, piece: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
        let corners = piece.iter().flat_map(|&t| self.problem.triangles()[t as usize]);
        corners.filter(|&v| !self.is_held(v))
    }

    /// Returns the neighbors of a vertex that are not held. `vertex` must not be held either.
    pub(super) fn neighbors(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        self.problem.ring_of(vertex).iter().copied().filter(|&k| !self.is_held(k))
    }

    /// Returns the pieces of the whole mesh, each a list of triangles.
    pub(super) fn all(&mut self) -> Vec<Vec<u32>> {
        let all: Vec<u32> = (0..self.piece_of.len() as u32).collect();
        self.parted(&all)
    }

    /// Divides a piece at the edges whose ends are both held by now. Returns the new pieces, except for pieces whose
    /// vertices are all held.
    pub(super) fn parted(&mut self, piece: &[u32]) -> Vec<Vec<u32>> {
        let first = self.count;
        // A piece of an earlier search is divided anew.
        let is_open = |of: u32| of == NONE || of < first;
        let mut found = Vec::new();
        for &seed in piece.iter() {
            if !is_open(self.piece_of[seed as usize]) {
                continue;
            }
            self.piece_of[seed as usize] = self.count;
            let mut part = vec![seed];
            let mut next = 0;
            while let Some(&t) = part.get(next) {
                next += 1;
                for edge in 3 * t..3 * t + 3 {
                    let other = self.across[edge as usize];
                    if other == NONE || self.parts(edge) {
                        continue;
                    }
                    let of = &mut self.piece_of[other as usize / 3];
                    if is_open(*of) {
                        *of = self.count;
                        part.push(other / 3);
                    }
                }
            }
            self.count += 1;
            if self.inside(&part).next().is_some() {
                found.push(part);
            }
        }
        found
    }

    /// Returns the closed boundaries of a piece: along held edges, and one for each held vertex without a held edge.
    pub(super) fn boundaries(&self, piece: &[u32]) -> Vec<Boundary> {
        let (mut seen, mut met) = (HashSet::new(), HashSet::new());
        let mut boundaries = Vec::new();
        for start in piece.iter().flat_map(|&t| 3 * t..3 * t + 3) {
            if !self.parts(start) || seen.contains(&start) {
                continue;
            }
            let mut boundary = Vec::new();
            let mut edge = start;
            while seen.insert(edge) {
                let vertex = self.edge(edge)[1];
                met.insert(vertex);
                let (next, inside) = self.turned(edge);
                boundary.push(Corner { vertex, inside });
                edge = next;
            }
            boundaries.push(boundary);
        }
        let mut lone: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for corners in piece.iter().map(|&t| self.problem.triangles()[t as usize]) {
            for vertex in corners.into_iter().filter(|v| self.is_held(*v) && !met.contains(v)) {
                let others = corners.into_iter().filter(|&v| v != vertex);
                lone.entry(vertex).or_default().extend(others);
            }
        }
        let lone = lone.into_iter().map(|(vertex, inside)| vec![Corner { vertex, inside }]);
        boundaries.extend(lone);
        boundaries
    }

    /// Returns the held half-edge that follows `edge` around the piece on its left, and the vertices inside between the
    /// two.
    fn turned(&self, edge: u32) -> (u32, Vec<u32>) {
        let mut inside = Vec::new();
        let mut next = following(edge);
        while !self.parts(next) {
            inside.push(self.edge(next)[1]);
            match self.across[next as usize] {
                // Edges on the boundary of the mesh have two fixed ends, so this case never occurs.
                NONE => break,
                other => next = following(other),
            }
        }
        (next, inside)
    }

    /// Returns the start and the end of a half-edge.
    fn edge(&self, edge: u32) -> [u32; 2] {
        let corners = self.problem.triangles()[edge as usize / 3];
        [corners[edge as usize % 3], corners[(edge as usize + 1) % 3]]
    }

    /// Returns whether a half-edge divides pieces: both of its ends are held.
    fn parts(&self, edge: u32) -> bool {
        self.edge(edge).iter().all(|&v| self.is_held(v))
    }
}

/// Returns the next half-edge of the triangle, counter-clockwise.
fn following(edge: u32) -> u32 {
    edge / 3 * 3 + (edge + 1) % 3
}

/// Returns for each half-edge the opposite half-edge in the triangle across, or `NONE`.
fn across(triangles: &[[u32; 3]]) -> Vec<u32> {
    let key = |a: u32, b: u32| u64::from(a.min(b)) << 32 | u64::from(a.max(b));
    let mut edges: Vec<(u64, u32)> = Vec::with_capacity(3 * triangles.len());
    for &[a, b, c] in triangles {
        let first = edges.len() as u32;
        edges.extend([(key(a, b), first), (key(b, c), first + 1), (key(c, a), first + 2)]);
    }
    edges.sort_unstable();
    let mut across = vec![NONE; edges.len()];
    for same in edges.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, one), (_, other)] = *same {
            across[one as usize] = other;
            across[other as usize] = one;
        }
    }
    across
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::prepare;
    use crate::mesh::Mesh;
    use glam::DVec2;

    /// Returns a square of 9 × 9 vertices without its central cell. With `lone`, one more vertex inside is fixed.
    fn square_with_a_hole(lone: bool) -> Problem {
        let points = (0..81).map(|k| [f64::from(k % 9), f64::from(k / 9)]).collect();
        let cells = (0..72u32).filter(|k| k % 9 < 8 && *k != 4 * 9 + 4);
        let triangles = cells.flat_map(|k| [[k, k + 1, k + 10], [k, k + 10, k + 9]]).collect();
        let fixed = if lone { vec![2 * 9 + 2] } else { Vec::new() };
        prepare(&Mesh { points, triangles, fixed, ..Mesh::default() }).unwrap().1
    }

    /// Returns twice the area that a boundary encloses, negative if the boundary runs clockwise.
    fn doubled_area(problem: &Problem, boundary: &Boundary) -> f64 {
        let at = |corner: &Corner| problem.positions()[corner.vertex as usize];
        let next = boundary.iter().skip(1).chain(boundary.first());
        boundary.iter().zip(next).map(|(a, b)| at(a).perp_dot(at(b))).sum()
    }

    #[test]
    fn boundaries_have_the_piece_on_their_left() {
        let problem = square_with_a_hole(true);
        let mut pieces = Pieces::new(&problem);
        let all = pieces.all();
        assert_eq!(all.len(), 1);
        let mut boundaries = pieces.boundaries(&all[0]);
        boundaries.sort_by_key(Vec::len);
        let lengths: Vec<usize> = boundaries.iter().map(Vec::len).collect();
        // The square has 32 boundary vertices. Two corners of the square are left out, as their triangles have no free
        // vertex.
        assert_eq!(lengths, [1, 4, 30]);
        // The mesh of unit cells is scaled by a power of two.
        let scale = doubled_area(&problem, &boundaries[2]) / 126.0;
        assert!(scale > 0.0 && scale.log2().fract() == 0.0);
        assert_eq!(doubled_area(&problem, &boundaries[1]), -2.0 * scale);
        // A lone fixed vertex has six neighbors inside, each in two triangles.
        assert_eq!(boundaries[0][0].inside.len(), 12);
        let touches =
            |v: &u32| problem.ring_of(*v).iter().any(|&k| k as usize >= problem.free_count());
        let inside = boundaries.iter().flatten().flat_map(|corner| &corner.inside);
        assert!(inside.clone().all(|v| !pieces.is_held(*v) && touches(v)));
    }

    #[test]
    fn a_path_joins_two_boundaries_and_another_one_parts_the_piece() {
        let problem = square_with_a_hole(false);
        let mut pieces = Pieces::new(&problem);
        let all = pieces.all();
        let (_, scale) = problem.normalization();
        let hold = |pieces: &mut Pieces<'_>, columns: std::ops::Range<u32>| {
            for x in columns {
                let place = DVec2::new(f64::from(x), 4.0) * scale;
                let at = |p: &DVec2| p.distance(place) < 1e-9;
                let v = problem.positions().iter().position(at).unwrap();
                pieces.hold(v as u32);
            }
        };
        hold(&mut pieces, 1..4);
        let joined = pieces.parted(&all[0]);
        assert_eq!(joined.len(), 1);
        let boundaries = pieces.boundaries(&joined[0]);
        assert_eq!(boundaries.len(), 1);
        // The boundary passes the path and its ends on both sides, except at two triangles whose vertices are all held.
        assert_eq!(boundaries[0].len(), 30 + 4 + 2 * 4 - 2);
        hold(&mut pieces, 6..8);
        let parted = pieces.parted(&joined[0]);
        assert_eq!(parted.len(), 2);
        let held = problem.triangles().iter().filter(|t| t.iter().all(|&v| pieces.is_held(v)));
        let others = problem.triangles().len() - held.count();
        assert_eq!(parted.iter().map(Vec::len).sum::<usize>(), others);
        assert!(parted.iter().all(|piece| pieces.boundaries(piece).len() == 1));
    }
}
