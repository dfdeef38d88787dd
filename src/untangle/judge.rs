//! Counts the bad triangles of a mesh by exact predicates, on positions as they are stored.

use std::collections::HashSet;

use glam::DVec2;

use crate::error::BadTriangle;
use crate::layout::Problem;
use crate::mesh::Mesh;
use crate::parallel::pace::now;
use crate::plane::Storage;
use crate::topology::Topology;
use crate::topology::overlapping_star;
use crate::topology::predicates::{not_positive, orientation};

/// A mesh with the form of storage in which exact predicates judge its triangles.
pub(super) struct Judge<'m> {
    pub(super) mesh: &'m Mesh,
    pub(super) topology: &'m Topology<'m>,
    pub(super) problem: &'m Problem,
    /// The form in which exact predicates judge the triangles.
    pub(super) stored: Storage<'m>,
}

impl Judge<'_> {
    /// Returns the corners of the mesh that are inverted or flat with the vertices at `points`, in ascending order, and
    /// the number of corners that exact predicates find inverted or flat. Elements with a free vertex that are too
    /// flat for double precision are in the list too. Indices are those of [`Topology::corners`].
    pub(super) fn bad_corners(&self, points: &[[f64; 2]]) -> (Vec<BadTriangle>, usize) {
        let corners = self.topology.corners();
        let exact = now(not_positive(points, corners)).into_iter();
        let flat = |vertices: &[u32; 3]| orientation(points, vertices) == 0.0;
        let described = exact.map(|corner| {
            let vertices = corners[corner as usize];
            BadTriangle { triangle: corner as usize, vertices, flat: flat(&vertices) }
        });
        let mut bad: Vec<BadTriangle> = described.collect();
        let exact: HashSet<usize> = bad.iter().map(|bad| bad.triangle).collect();
        let beyond =
            now(self.problem.beyond_precision(&now(self.problem.normalized(points, Vec::new()))));
        for corner in self.problem.in_mesh(&beyond, self.topology) {
            let (index, vertices) = (corner as usize, corners[corner as usize]);
            let can_move = vertices.iter().any(|&v| self.topology.free()[v as usize]);
            if !exact.contains(&index) && can_move {
                bad.push(BadTriangle { triangle: index, vertices, flat: true });
            }
        }
        bad.sort_unstable_by_key(|bad| bad.triangle);
        (bad, exact.len())
    }

    /// Judges normalized positions of the problem, converted to the units of the mesh and to stored positions.
    pub(super) fn judged(&self, positions: &[DVec2]) -> Judgment {
        let mut points = self.problem.denormalize(self.mesh, positions);
        for (v, point) in points.iter_mut().enumerate() {
            *point = self.stored.rounded(v, *point);
        }
        let (left, exactly_bad) = self.bad_corners(&points);
        let overlapping = match left.is_empty() {
            true => {
                let (corners, free) = (self.topology.corner_list(), self.topology.free());
                overlapping_star(&points, corners, free).map(|(v, _)| v)
            }
            false => None,
        };
        Judgment { points, left, exactly_bad, overlapping }
    }
}

/// The rounded points of a mesh, with the bad triangles that they have.
pub(super) struct Judgment {
    /// Position of every vertex, in the order and units of the mesh, as it is stored.
    pub(super) points: Vec<[f64; 2]>,
    /// Inverted and flat corners, see [`Judge::bad_corners`].
    pub(super) left: Vec<BadTriangle>,
    /// Number of corners that exact predicates find inverted or flat.
    pub(super) exactly_bad: usize,
    /// If `left` is empty: the first free vertex around which triangles wind more than once. `None` if there is no such
    /// vertex.
    pub(super) overlapping: Option<u32>,
}
