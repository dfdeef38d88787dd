//! How far a mesh is untangled, by exact predicates on the values that will be stored.

use std::collections::HashSet;

use glam::DVec2;

use crate::error::BadTriangle;
use crate::layout::Problem;
use crate::mesh::Mesh;
use crate::precision::Precision;
use crate::topology::Topology;
use crate::topology::overlapping_star;
use crate::topology::predicates::bad_triangles;

/// The mesh that is judged.
pub(super) struct Judge<'m> {
    pub(super) mesh: &'m Mesh,
    pub(super) topology: &'m Topology<'m>,
    pub(super) problem: &'m Problem,
    /// The precision in which points will be stored.
    pub(super) stored: Precision,
}

impl Judge<'_> {
    /// The triangles of the mesh that are inverted or flat with the vertices at `points`, and those with a free vertex that
    /// are so flat that double precision cannot judge them. In ascending order.
    pub(super) fn bad_triangles(&self, points: &[[f64; 2]]) -> Vec<BadTriangle> {
        let triangles = self.topology.triangles();
        let mut bad = bad_triangles(points, triangles);
        let exact: HashSet<usize> = bad.iter().map(|bad| bad.triangle).collect();
        let beyond = self.problem.beyond_precision(&self.problem.normalized(points, Vec::new()));
        for triangle in self.problem.in_mesh(&beyond, triangles) {
            if !exact.contains(&triangle) && self.topology.can_move(triangle) {
                bad.push(BadTriangle { triangle, vertices: triangles[triangle], flat: true });
            }
        }
        bad.sort_unstable_by_key(|bad| bad.triangle);
        bad
    }

    /// Judges positions of the problem, rounded to what will be stored.
    pub(super) fn judged(&self, positions: &[DVec2]) -> Judgment {
        let mut points = self.problem.denormalize(self.mesh, positions);
        for x in points.as_flattened_mut() {
            *x = self.stored.rounded(*x);
        }
        let triangles = self.topology.triangles();
        let left = self.bad_triangles(&points);
        let overlapping = match left.is_empty() {
            true => overlapping_star(&points, triangles, self.topology.free()).map(|(v, _)| v),
            false => None,
        };
        Judgment { points, left, overlapping }
    }
}

/// What is wrong with a mesh.
pub(super) struct Judgment {
    /// The positions in the mesh's order and units.
    pub(super) points: Vec<[f64; 2]>,
    /// See [`Judge::bad_triangles`].
    pub(super) left: Vec<BadTriangle>,
    /// If `left` is empty: a vertex around which triangles wind more than once, if there is one.
    pub(super) overlapping: Option<u32>,
}
