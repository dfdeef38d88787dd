//! The progress and the result of an untangling.

use crate::error::{BadQuadrilateral, BadTriangle};
use crate::topology::Topology;

/// The progress of an [`Untangle`](super::Untangle), for a display.
#[derive(Clone, Copy, Debug)]
pub struct Untangling {
    /// Number of completed sweeps.
    pub sweep: u32,
    /// Number of corners that are inverted or flat in double precision, among the corners that the sweep changes: triangles, and
    /// corners of quadrilaterals.
    pub bad: usize,
    /// Number of corners that no move of vertices can mend: triangles, and corners of quadrilaterals. The number is the same for
    /// all sweeps; see [`Untangled::hopeless`].
    pub hopeless: usize,
}

/// The result of an [`Untangle`](super::Untangle).
#[derive(Clone, Debug)]
pub struct Untangled {
    /// Position of every vertex, in the order and units of the mesh. Fixed vertices keep their coordinates.
    pub points: Vec<[f64; 2]>,
    /// Number of inverted or flat triangles of the given mesh, and of corners of quadrilaterals that are not convex. Those too
    /// flat for double precision count as flat.
    pub bad_before: usize,
    /// Triangles of the result that are inverted or flat, by exact predicates on `points`. The list is in ascending
    /// order, and empty if the mesh is untangled. Triangles that double precision cannot judge
    /// ([`Smoother::beyond_precision`](crate::Smoother::beyond_precision)) are listed as flat if they have a free
    /// vertex.
    pub left: Vec<BadTriangle>,
    /// Corners of quadrilaterals of the result that are not convex, as for `left`.
    pub left_quadrilaterals: Vec<BadQuadrilateral>,
    /// Bad triangles of the given mesh without a free vertex, or with two fixed vertices at the same point. No move of
    /// vertices can make such triangles feasible.
    pub hopeless: Vec<BadTriangle>,
    /// Corners of quadrilaterals of the given mesh that are not convex, as for `hopeless`.
    pub hopeless_quadrilaterals: Vec<BadQuadrilateral>,
    /// A free vertex around which triangles wind more than once, although every triangle is feasible. `None` if there
    /// is no such vertex, or if triangles are left bad.
    pub overlapping: Option<u32>,
    /// Number of completed sweeps, over all starts.
    pub sweeps: u32,
    /// Number of vertices whose coordinates in `points` differ from those of the given mesh.
    pub moved: usize,
}

impl Untangled {
    /// Returns the progress after the present number of sweeps, with the number of bad corners.
    pub(super) fn progress(&self, bad: usize) -> Untangling {
        Untangling { sweep: self.sweeps, bad, hopeless: self.hopeless.len() }
    }

    /// Returns whether all elements are feasible, and no elements overlap around a vertex.
    pub fn is_feasible(&self) -> bool {
        self.left.is_empty() && self.left_quadrilaterals.is_empty() && self.overlapping.is_none()
    }

    /// Moves the corners of quadrilaterals from the lists of triangles to lists of their own. Before, all lists have corners of
    /// `topology`.
    pub(super) fn separated(mut self, topology: &Topology<'_>, given: &[[f64; 2]]) -> Self {
        let first = topology.triangles().len();
        let separate = |list: &mut Vec<BadTriangle>, points: &[[f64; 2]]| {
            let of_triangles = list.partition_point(|bad| bad.triangle < first);
            let others: Vec<u32> =
                list.split_off(of_triangles).iter().map(|bad| bad.triangle as u32).collect();
            topology.described(points, &others).1
        };
        self.left_quadrilaterals = separate(&mut self.left, &self.points);
        self.hopeless_quadrilaterals = separate(&mut self.hopeless, given);
        self
    }
}
