//! Quadrilaterals and polygons beside the triangles of a mesh, which pictures draw without the color of a measure.

use std::collections::{HashMap, HashSet};

use gpu_smooth::{Mesh, Topology};

use crate::load::LoadedMesh;
use crate::render::picture::color::UNJUDGED;

/// Longitudes of a face that differ by more than this number of degrees belong to both sides of the cut of a map.
const MAX_LONGITUDES: f64 = 180.0;

/// The quadrilaterals and polygons of a mesh, by vertex index. No smoothing moves their corners.
pub(crate) struct FixedFaces {
    /// Triangles that cover the faces. Their vertices are corners of the faces.
    pub(crate) pieces: Vec<[u32; 3]>,
    /// For each piece, the index of its quadrilateral among those of the topology; `None` for faces that are no elements.
    quadrilateral_of: Vec<Option<usize>>,
    /// Each edge once, without the edges that [`inner_edges`](super::outlines::inner_edges) of the triangles has.
    pub(crate) edges: Vec<FaceEdge>,
    /// Boundary of triangles and faces together: edges of one triangle or one face each.
    pub(crate) boundary: Vec<[u32; 2]>,
    /// Number of faces.
    pub(crate) count: usize,
    has_polygons: bool,
    /// Whether vertices of quadrilaterals move.
    moves: bool,
}

/// An edge of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FaceEdge {
    /// The smaller vertex first.
    pub(crate) ends: [u32; 2],
    /// Index of a piece that has the edge.
    pub(crate) piece: usize,
    /// Whether several faces have the edge.
    is_shared: bool,
}

impl FixedFaces {
    /// Collects the faces of a file. `topology` is that of the triangles of the file.
    pub(crate) fn of(file: &LoadedMesh, topology: &Topology<'_>) -> Self {
        let points = &file.mesh().points;
        let is_whole = |corners: &[u32]| {
            let longitudes = corners.iter().map(|&v| points[v as usize][0]);
            let west = longitudes.clone().fold(f64::INFINITY, f64::min);
            file.chart().is_none() || longitudes.fold(west, f64::max) - west <= MAX_LONGITUDES
        };
        let faces = file.source.other_faces().filter(|corners| is_whole(corners));
        let moves = file.domain.moves_quadrilaterals();
        let of_triangles = match file.mesh() {
            mesh if moves => {
                let alone = Mesh { quadrilaterals: Vec::new(), ..mesh.clone() };
                Topology::new(&alone).map(|topology| topology.boundary_edges())
            }
            _ => Ok(topology.boundary_edges()),
        };
        // Without a triangle, there is no topology of triangles.
        let sorted = |vertices: &[u32]| {
            let mut vertices = vertices.to_vec();
            vertices.sort_unstable();
            vertices
        };
        let elements = topology.quadrilaterals().map(|vertices| sorted(&vertices)).zip(0..);
        let number: HashMap<Vec<u32>, usize> = elements.collect();
        let of = |corners: &[u32]| number.get(&sorted(corners)).copied();
        Self { moves, ..Self::new(faces, points, of_triangles.unwrap_or_default(), of) }
    }

    /// Returns the rating of a piece, given those of all elements, triangles first: that of its quadrilateral, or that of faces
    /// which no measure judges.
    pub(crate) fn goodness(&self, piece: usize, triangles: usize, goodness: &[f32]) -> f32 {
        let of_element = self.quadrilateral_of[piece].and_then(|k| goodness.get(triangles + k));
        // A measure of triangles alone has no value.
        of_element.copied().filter(|goodness| !goodness.is_nan()).unwrap_or(UNJUDGED)
    }

    /// Returns whether a piece belongs to a quadrilateral of the topology.
    pub(crate) fn is_of_element(&self, piece: usize) -> bool {
        self.quadrilateral_of[piece].is_some()
    }

    /// `of_triangles` is the boundary of the triangles. `number` returns the index of a quadrilateral of the topology, given its
    /// vertices.
    fn new<'a>(
        faces: impl Iterator<Item = &'a [u32]>,
        points: &[[f64; 2]],
        of_triangles: Vec<[u32; 2]>,
        number: impl Fn(&[u32]) -> Option<usize>,
    ) -> Self {
        let (mut pieces, mut edges) = (Vec::new(), Vec::new());
        let mut quadrilateral_of = Vec::new();
        let (mut count, mut has_polygons) = (0, false);
        let mut known: HashMap<[u32; 2], usize> = HashMap::new();
        for corners in faces {
            let mut corners = corners.to_vec();
            corners.dedup();
            if corners.first() == corners.last() {
                corners.pop();
            }
            if corners.len() < 3 {
                continue;
            }
            count += 1;
            has_polygons |= corners.len() > 4;
            let first = pieces.len();
            let quadrilateral = number(&corners);
            rotate_to_fan(&mut corners, points);
            let [tip, rest @ ..] = &corners[..] else { continue };
            pieces.extend(rest.windows(2).map(|pair| [*tip, pair[0], pair[1]]));
            quadrilateral_of.resize(pieces.len(), quadrilateral);
            for (i, &a) in corners.iter().enumerate() {
                let b = corners[(i + 1) % corners.len()];
                let ends = [a.min(b), a.max(b)];
                // Each edge but the two at the tip belongs to a piece of its own.
                let piece = (first + i.saturating_sub(1)).min(pieces.len() - 1);
                let index = *known.entry(ends).or_insert(edges.len());
                match edges.get_mut(index) {
                    None => edges.push(FaceEdge { ends, piece, is_shared: false }),
                    Some(edge) => edge.is_shared = true,
                }
            }
        }
        let boundary = boundary(&edges, &of_triangles);
        let drawn: HashSet<[u32; 2]> = of_triangles.into_iter().collect();
        edges.retain(|edge| !drawn.contains(&edge.ends));
        let moves = false;
        Self { pieces, quadrilateral_of, edges, boundary, count, has_polygons, moves }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    /// Returns the name of the faces that no measure judges, for a legend; `None` without such faces.
    pub(crate) fn unjudged(&self) -> Option<&'static str> {
        let is_judged = self.quadrilateral_of.iter().all(Option::is_some);
        self.name().filter(|_| !is_judged)
    }

    /// Returns the name of the faces; `None` without faces.
    pub(crate) fn name(&self) -> Option<&'static str> {
        let name = match self.has_polygons {
            true => "fixed polygon",
            false if self.moves => "quadrilateral",
            false => "fixed quadrilateral",
        };
        (!self.is_empty()).then_some(name)
    }
}

/// Returns the boundary of triangles and faces together, from the edges of the faces and the boundary of the triangles.
fn boundary(edges: &[FaceEdge], of_triangles: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let sorted = |&[a, b]: &[u32; 2]| [a.min(b), a.max(b)];
    let of_faces: HashSet<[u32; 2]> = edges.iter().map(|edge| edge.ends).collect();
    let (inner, mut boundary): (Vec<_>, Vec<_>) =
        of_triangles.iter().partition(|edge| of_faces.contains(&sorted(edge)));
    let inner: HashSet<[u32; 2]> = inner.iter().map(sorted).collect();
    let outer = edges.iter().filter(|edge| !edge.is_shared).map(|edge| edge.ends);
    boundary.extend(outer.filter(|ends| !inner.contains(ends)));
    boundary
}

/// Rotates the corners of a face so that all triangles from the first corner to the edges have one orientation, and thus
/// cover a face that is not convex. Leaves corners unchanged for which no such rotation exists.
fn rotate_to_fan(corners: &mut [u32], points: &[[f64; 2]]) {
    let is_fan = |tip: usize| {
        let corner = |i: usize| points[corners[(tip + i) % corners.len()] as usize];
        let area = |i: usize| {
            let [p, q, r] = [0, i, i + 1].map(corner);
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        };
        let mut areas = (1..corners.len() - 1).map(area);
        areas.clone().all(|area| area >= 0.0) || areas.all(|area| area <= 0.0)
    };
    if let Some(tip) = (0..corners.len()).find(|&tip| is_fan(tip)) {
        corners.rotate_left(tip);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [[f64; 2]; 7] =
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0], [0.8, 0.8]];

    fn area(points: [[f64; 2]; 3]) -> f64 {
        let [p, q, r] = points;
        0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])).abs()
    }

    #[test]
    fn pieces_cover_faces_and_each_edge_is_listed_once() {
        // A square, a quadrilateral with a reflex corner at vertex 6, and a face with a repeated corner.
        let faces: [&[u32]; 3] = [&[1, 4, 5, 2], &[1, 2, 3, 6], &[0, 1, 1, 6]];
        let faces = FixedFaces::new(faces.into_iter(), &POINTS, vec![], |_| None);
        assert_eq!(
            (faces.count, faces.pieces.len(), faces.name()),
            (3, 5, Some("fixed quadrilateral"))
        );
        let areas = faces.pieces.iter().map(|piece| area(piece.map(|v| POINTS[v as usize])));
        // The triangle 1-2-3 contains vertex 6, so the quadrilateral is the triangle without the triangle 1-3-6.
        let concave = 0.5 - area([POINTS[1], POINTS[3], POINTS[6]]);
        assert!((areas.sum::<f64>() - 1.0 - concave - 0.4).abs() < 1e-12);
        assert_eq!(faces.edges.len(), 9);
        for FaceEdge { ends, piece, .. } in &faces.edges {
            assert!(ends.iter().all(|end| faces.pieces[*piece].contains(end)), "{ends:?}");
        }
        let shared: Vec<_> =
            faces.edges.iter().filter(|edge| edge.is_shared).map(|edge| edge.ends).collect();
        assert_eq!(shared, [[1, 2], [1, 6]]);
    }

    #[test]
    fn edges_between_triangles_and_faces_are_no_boundary() {
        let faces: [&[u32]; 1] = [&[1, 4, 5, 2]];
        let of_triangles = vec![[0, 1], [1, 2], [2, 3], [3, 0]];
        let faces = FixedFaces::new(faces.into_iter(), &POINTS, of_triangles, |_| None);
        let mut boundary = faces.boundary.clone();
        boundary.sort_unstable();
        assert_eq!(boundary, [[0, 1], [1, 4], [2, 3], [2, 5], [3, 0], [4, 5]]);
        // The edge from 1 to 2 is drawn with the triangles.
        let drawn: Vec<_> = faces.edges.iter().map(|edge| edge.ends).collect();
        assert_eq!(drawn, [[1, 4], [4, 5], [2, 5]]);
    }
}
