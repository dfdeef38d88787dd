//! The triangles around one vertex, for visits of single vertices on the host.

use glam::DVec2;

use crate::layout::{MeshCoordinates, Problem};
use crate::measure::altitude;
use crate::metric::{Corner, Dual, Ideal, Own, TargetMap};
use crate::patch::corners::Corners;
use crate::topology::Topology;
use crate::topology::predicates::is_positive;

/// Vertex numbers of the triangles around one vertex. Each triangle starts with the common vertex.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fan(Vec<[u32; 3]>);

impl Fan {
    pub(crate) fn new(topology: &Topology<'_>, vertex: u32) -> Self {
        let own_first = |&t: &u32| {
            let mut corners = topology.triangles()[t as usize];
            let own = corners.iter().position(|&v| v == vertex).unwrap_or(0);
            corners.rotate_left(own);
            corners
        };
        Self(topology.star(vertex).iter().map(own_first).collect())
    }

    /// Replaces every vertex index `v` by `number[v]`.
    pub(crate) fn renumber(&mut self, number: &[u32]) {
        self.0.as_flattened_mut().iter_mut().for_each(|v| *v = number[*v as usize]);
    }

    /// Returns the triangles, each with the common vertex first.
    pub(crate) fn triangles(&self) -> &[[u32; 3]] {
        &self.0
    }

    /// Returns the common vertex of the triangles, 0 if there are none.
    pub(crate) fn own(&self) -> u32 {
        self.0.first().map_or(0, |corners| corners[0])
    }

    /// Gathers positions and target maps of the triangles. Trials with an altitude below `min_altitude` (normalized; 0
    /// for no limit) are infeasible.
    pub(crate) fn patch(
        &self,
        problem: &Problem,
        positions: &[DVec2],
        min_altitude: f64,
    ) -> FanPatch {
        let corner = |t: &[u32; 3]| FanCorner {
            ends: [t[1], t[2]].map(|v| positions[v as usize]),
            map: problem.target_map(t),
        };
        let corners = self.0.iter().map(corner).collect();
        let (ideal, coordinates) = (problem.ideal(), problem.coordinates());
        FanPatch { corners, ideal, coordinates, min_altitude }
    }
}

/// A triangle at the visited vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FanCorner {
    /// Positions of the other two corners, counter-clockwise.
    pub(crate) ends: [DVec2; 2],
    /// Target map of the triangle, `None` if the mesh has no targets.
    pub(crate) map: Option<TargetMap<f64>>,
}

impl FanCorner {
    /// Returns the triangle in the plane, with the visited vertex at `at`.
    pub(crate) fn in_plane(&self, at: DVec2, ideal: Ideal) -> Corner<f64> {
        let [a, b] = self.ends.map(|end| (end - at).to_array());
        Corner { a, b, ideal }
    }
}

/// The triangles around one vertex in coordinates, for any position of the vertex.
#[derive(Clone, Debug)]
pub(crate) struct FanPatch {
    pub(crate) corners: Vec<FanCorner>,
    pub(crate) ideal: Ideal,
    /// Coordinates in which altitudes are measured.
    pub(crate) coordinates: MeshCoordinates,
    /// Lower limit of triangles' altitudes, normalized; 0 for no limit.
    pub(crate) min_altitude: f64,
}

impl Corners<f64> for FanPatch {
    type Slopes = Own;

    fn count(&self) -> usize {
        self.corners.len()
    }

    fn slopes(&self, _: usize) -> Own {
        Own
    }

    fn corner(&self, i: usize, at: [f64; 2]) -> Corner<f64> {
        let corner = self.corners[i].in_plane(at.into(), self.ideal);
        self.corners[i].map.map_or(corner, |map| map.transform(&corner))
    }

    fn pull_back(&self, i: usize, transformed: Dual) -> Dual {
        self.corners[i].map.map_or(transformed, |map| map.pull_back(transformed))
    }

    /// Returns whether a triangle is counter-clockwise, by its exact sign and by its rounded area, and has at least the
    /// minimum altitude.
    fn is_positive(&self, i: usize, at: [f64; 2], corner: &Corner<f64>) -> bool {
        let [p, q] = self.corners[i].ends;
        is_positive(&[at, p.into(), q.into()], &[0, 1, 2])
            && corner.doubled_area() > 0.0
            && (self.min_altitude <= 0.0
                || altitude([at.into(), p, q].map(|at| self.coordinates.at(at)))
                    >= self.min_altitude)
    }
}
