//! Untangling: moves free vertices until no triangle is inverted or flat.
//!
//! Free vertices far outside of the mesh first return to means of their neighbors (`distant`). Sweeps of Newton steps
//! then lower an `energy` that is finite for inverted triangles too. At first, only vertices near bad
//! triangles move, then vertices within more edges. If triangles stay bad, the free vertices are moved to the means of
//! their neighbors, and a step from coarser levels follows each sweep. Then the mesh is cut (`cuts`) into pieces, in
//! which the means of neighbors are a good start. At last, Newton steps move all vertices of the given mesh at once.

mod cuts;
mod distant;
pub(crate) mod energy;
mod judge;
mod means;
mod newton;
mod patches;
mod pieces;
mod result;
mod stages;
mod state;
mod work;

use std::ops::ControlFlow;

use crate::error::MeshError;
use crate::mesh::Mesh;
use crate::plane::{Plane, Storage};
use crate::precision::Precision;
pub(crate) use means::feasible_means;
pub use result::{Untangled, Untangling};

/// The observer of an untangling, called after each sweep.
type Observe<'r> = dyn FnMut(&Untangling) -> ControlFlow<()> + 'r;

/// An untangling that has not begun: moves free vertices, on the CPU, until no triangle is inverted or flat. It begins by
/// [`run`](Self::run). Connectivity, boundary and fixed vertices stay. Triangles too flat for double precision are opened as
/// well. If moves of the vertices near bad triangles suffice, all other vertices keep their coordinates. Free vertices more
/// than 1,000 times the size of the mesh outside of the mesh begin at means of their neighbors.
///
/// Windings are first made consistent across edges. The boundary of each connected part then encloses a positive area.
///
/// The energy and its regularization are by Garanzha et al., *Foldover-free maps in 50 lines of code*, ACM Transactions
/// on Graphics 40 (2021). There is no proof that the method untangles every mesh for which feasible positions exist.
///
/// ```
/// use gpu_smooth::{Mesh, Smoother, Untangle};
///
/// // A square with one vertex, which should be inside, to the right of it.
/// let mesh = Mesh {
///     points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.5, 0.5]],
///     triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
///     fixed: vec![],
///     ..Mesh::default()
/// };
/// assert!(Smoother::new(&mesh).is_err());
/// let untangled = Untangle::new(&mesh).run()?;
/// assert!(untangled.left.is_empty() && untangled.overlapping.is_none());
/// let mesh = Mesh { points: untangled.points, ..mesh };
/// Smoother::new(&mesh)?;
/// # Ok::<(), gpu_smooth::MeshError>(())
/// ```
#[must_use = "an untangling begins by `run`"]
pub struct Untangle<'r> {
    mesh: &'r Mesh,
    stored: Precision,
    plane: Option<Plane>,
    observe: Box<Observe<'r>>,
}

impl<'r> Untangle<'r> {
    /// Returns an untangling of a mesh whose points are stored in double precision.
    pub fn new(mesh: &'r Mesh) -> Self {
        let observe = Box::new(|_: &Untangling| ControlFlow::Continue(()));
        Self { mesh, stored: Precision::Double, plane: None, observe }
    }

    /// Sets the precision of the file or buffer to be written. Points are rounded to this precision before exact predicates
    /// judge the triangles.
    pub fn stored(self, stored: Precision) -> Self {
        Self { stored, ..self }
    }

    /// Sets the plane of space in which the vertices of the mesh lie; `None` for the plane of x and y. In a tilted plane,
    /// exact predicates judge the triangles after the coordinates in space were rounded to the plane's precision.
    pub fn in_plane(self, plane: Option<&Plane>) -> Self {
        Self { plane: plane.cloned(), ..self }
    }

    /// Sets a callback that is called after each sweep. If the callback breaks, the result has the best points reached so
    /// far.
    pub fn observe(self, observe: impl FnMut(&Untangling) -> ControlFlow<()> + 'r) -> Self {
        Self { observe: Box::new(observe), ..self }
    }

    /// Untangles the mesh, and blocks until the untangling ends.
    ///
    /// # Errors
    /// [`MeshError`] if the mesh is not a valid plane mesh; see [`Topology::by_area`](crate::Topology::by_area).
    /// [`MeshError::Closed`] if an edge-connected part of a tangled mesh has no boundary edge. Triangles that stay inverted
    /// are no error: [`Untangled::left`] lists such triangles. [`MeshError::PointCount`] if the plane has another number of
    /// vertices than the mesh.
    pub fn run(mut self) -> Result<Untangled, MeshError> {
        let plane = self.plane.as_ref();
        let (given, expected) = (plane.map(|plane| plane.points().len()), self.mesh.points.len());
        if let Some(given) = given.filter(|&given| given != expected) {
            return Err(MeshError::PointCount { given, expected });
        }
        let stored = Storage::new(self.stored, plane);
        work::untangled(self.mesh, stored, &mut *self.observe)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::instructions::with_each_width;
    use crate::run::truncated::fixtures;

    #[test]
    fn untangling_has_the_same_bits_with_any_vector_instructions_and_without() {
        for is_whole in [|_: usize| false, |cell: usize| cell.is_multiple_of(3)] {
            let mut mesh = fixtures::quadrilaterals(13, is_whole);
            let before = mesh.points.clone();
            for k in (0..13u32).map(|k| (3 + k % 7) * 13 + 3 + (5 * k) % 7) {
                let k = k as usize;
                mesh.points[k] = [before[k][0] + 1.6, before[k][1] - 1.3];
            }
            let run = || {
                let untangled = Untangle::new(&mesh).run().unwrap();
                assert!(untangled.left.is_empty());
                untangled.points.into_iter().flatten().map(f64::to_bits).collect::<Vec<_>>()
            };
            let [new, old, none] = with_each_width(run);
            assert!(new == old && new == none);
        }
    }

    /// A caller need not wait for the other triangles if some can never be mended.
    #[test]
    fn triangles_that_no_move_mends_are_known_after_the_first_sweep() {
        let mut mesh = fixtures::quadrilaterals(13, |_| false);
        for k in [40, 58, 83, 97] {
            mesh.points[k] = [mesh.points[k][0] + 1.6, mesh.points[k][1] - 1.3];
        }
        // Two vertices of the boundary are at one point.
        mesh.points[1] = mesh.points[2];
        let mut sweeps = Vec::new();
        let untangled = Untangle::new(&mesh).observe(|now| {
            sweeps.push((now.sweep, now.hopeless));
            if now.hopeless > 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        let untangled = untangled.run().unwrap();
        assert_eq!(untangled.hopeless.len(), 1);
        assert_eq!((sweeps, untangled.sweeps), (vec![(1, 1)], 1));
    }
}
