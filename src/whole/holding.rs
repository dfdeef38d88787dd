//! Holds free vertices during a part of a run, as if they were fixed.

use glam::DVec2;

use crate::error::MeshError;
use crate::layout::{Problem, prepare};
use crate::mesh::Mesh;

/// A mesh of which some free vertices are held. Sweeps do not move these.
pub(crate) struct Holding<'s> {
    mesh: &'s Mesh,
    problem: &'s Problem,
    /// For each free vertex, by its number in the problem, whether it is held.
    pub(crate) held: Vec<bool>,
    /// The number in the problem of each vertex of the mesh.
    pub(crate) number: Vec<u32>,
}

impl<'s> Holding<'s> {
    /// Makes a holding in which no vertex is held yet.
    pub(crate) fn new(mesh: &'s Mesh, problem: &'s Problem) -> Self {
        let mut number = vec![u32::MAX; mesh.points.len()];
        for (new, &v) in (0..).zip(problem.vertices()) {
            number[v as usize] = new;
        }
        Self { mesh, problem, held: vec![false; problem.free_count()], number }
    }

    /// Returns the problem in which held vertices are fixed. `None` if no vertex is held, or all are.
    pub(crate) fn smaller(&self) -> Result<Option<Problem>, MeshError> {
        let count = self.held.iter().filter(|held| **held).count();
        if count == 0 || count == self.held.len() {
            return Ok(None);
        }
        let vertices = self.problem.vertices().iter().zip(&self.held);
        let held = vertices.filter(|(_, held)| **held).map(|(&v, _)| v);
        let Mesh { points, triangles, fixed } = self.mesh;
        let fixed = fixed.iter().copied().chain(held).collect();
        let mesh = Mesh { points: points.clone(), triangles: triangles.clone(), fixed };
        let (_, mut problem) = prepare(&mesh)?;
        problem.take_targets(self.problem, &self.number);
        Ok(Some(problem))
    }

    /// Returns positions in the order of another problem of the same mesh.
    pub(crate) fn renumbered(&self, positions: &[DVec2], other: &Problem) -> Vec<DVec2> {
        let of = |&v: &u32| positions[self.number[v as usize] as usize];
        other.vertices().iter().map(of).collect()
    }

    /// Returns positions in the order of this problem, given them in the order of another one.
    pub(crate) fn numbered_back(&self, positions: &[DVec2], other: &Problem) -> Vec<DVec2> {
        let mut back = vec![DVec2::ZERO; positions.len()];
        for (&v, &position) in other.vertices().iter().zip(positions) {
            back[self.number[v as usize] as usize] = position;
        }
        back
    }
}
