//! The corners that one vertex has in the elements around it, for visits of single vertices on the host.

use std::ops::Mul;

use glam::DVec2;

#[cfg(feature = "gpu")]
use crate::layout::OPPOSITE;
use crate::layout::{MeshCoordinates, Problem};
use crate::measure::altitude;
use crate::metric::{Corner, Dual, Given, Ideal, TargetMap};
use crate::patch::corners::Corners;
use crate::patch::role::{AroundVertex, Role};
use crate::topology::Topology;
use crate::topology::predicates::is_positive;

/// Vertex numbers of the corners that one vertex has in the elements around it. Each corner is written with the common vertex
/// first, and the other two counter-clockwise.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fan {
    corners: Vec<[u32; 3]>,
    /// The place of the common vertex in each corner.
    roles: Vec<Role>,
}

impl Fan {
    pub(crate) fn new(topology: &Topology<'_>, vertex: u32) -> Self {
        let triangles = topology.triangles().len() as u32;
        let own_first = |corner: u32| {
            let vertices = topology.corners()[corner as usize];
            let (role, [a, b]) = Role::of(vertices, corner >= triangles, vertex);
            ([vertex, a, b], role)
        };
        let (corners, roles) = topology.corners_with(vertex).map(own_first).unzip();
        Self { corners, roles }
    }

    /// Replaces every vertex index `v` by `number[v]`.
    pub(crate) fn renumber(&mut self, number: &[u32]) {
        self.corners.as_flattened_mut().iter_mut().for_each(|v| *v = number[*v as usize]);
    }

    /// Returns the vertices of the corners, each with the common vertex first.
    pub(crate) fn corners(&self) -> &[[u32; 3]] {
        &self.corners
    }

    /// Returns the other two vertices of each corner, counter-clockwise, in the form in which a device reads them: marks of
    /// [`OPPOSITE`] on both are the two bits of the role of the common vertex.
    #[cfg(feature = "gpu")]
    pub(crate) fn marked_others(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.corners.iter().zip(&self.roles).map(|(&[_, a, b], &role)| {
            let bit = |bit: u32| (role as u32 >> bit & 1) * OPPOSITE;
            [a | bit(0), b | bit(1)]
        })
    }

    /// Returns the common vertex of the corners, 0 if there are none.
    pub(crate) fn own(&self) -> u32 {
        self.corners.first().map_or(0, |corners| corners[0])
    }

    /// Gathers positions and target maps of the corners. Trials with an altitude below `min_altitude` (normalized; 0
    /// for no limit) are infeasible.
    pub(crate) fn patch(
        &self,
        problem: &Problem,
        positions: &[DVec2],
        min_altitude: f64,
    ) -> FanPatch {
        let corner = |(t, &role): (&[u32; 3], &Role)| FanCorner {
            ends: [t[1], t[2]].map(|v| positions[v as usize]),
            map: problem.target_map(t),
            role,
        };
        let corners = self.corners.iter().zip(&self.roles).map(corner).collect();
        let others = self.corners.iter().map(|&[_, a, b]| [a, b]);
        let quadrilaterals = AroundVertex::all(self.roles.iter().copied().zip(others));
        let opposite = |AroundVertex { first, opposite }: AroundVertex| {
            (first, problem.corner_of(true, &opposite, |v| positions[v as usize]))
        };
        let opposites = quadrilaterals.map(opposite).collect();
        let (ideal, coordinates) = (problem.ideal(), problem.coordinates());
        FanPatch { corners, opposites, ideal, coordinates, min_altitude }
    }
}

/// A corner with the visited vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FanCorner {
    /// Positions of the other two vertices, counter-clockwise.
    pub(crate) ends: [DVec2; 2],
    /// Target map of the corner, `None` if the mesh has no targets.
    pub(crate) map: Option<TargetMap<f64>>,
    /// The place of the visited vertex in the corner.
    pub(crate) role: Role,
}

impl FanCorner {
    /// Returns the positions of the vertices, counter-clockwise, with the visited vertex at `at`.
    pub(crate) fn vertices(&self, at: DVec2) -> [DVec2; 3] {
        self.role.vertices(at, self.ends)
    }

    /// Returns the edges of the corner in the plane, with the visited vertex at `at`.
    pub(crate) fn edges(&self, at: DVec2, ideal: Ideal) -> Corner<f64> {
        let [p, q, r] = self.vertices(at);
        Corner { a: (q - p).to_array(), b: (r - p).to_array(), ideal }
    }

    /// Returns the corner in the form of the metrics, with the visited vertex at `at`.
    pub(crate) fn in_plane(&self, at: DVec2, ideal: Ideal) -> Corner<f64> {
        let corner = self.edges(at, ideal);
        if self.role.is_right() { corner.of_right_angle() } else { corner }
    }

    /// Returns [`in_plane`](Self::in_plane), transformed by the target map.
    pub(crate) fn seen(&self, at: DVec2, ideal: Ideal) -> Corner<f64> {
        let corner = self.in_plane(at, ideal);
        self.map.map_or(corner, |map| map.transform(&corner))
    }
}

/// The corners around one vertex in coordinates, for any position of the vertex.
#[derive(Clone, Debug)]
pub(crate) struct FanPatch {
    pub(crate) corners: Vec<FanCorner>,
    /// For each quadrilateral, the index of its corner at the common vertex, and its corner opposite that vertex, transformed by
    /// the target map.
    pub(crate) opposites: Vec<(usize, Corner<f64>)>,
    pub(crate) ideal: Ideal,
    /// Coordinates in which altitudes are measured.
    pub(crate) coordinates: MeshCoordinates,
    /// Lower limit of corners' altitudes, normalized; 0 for no limit.
    pub(crate) min_altitude: f64,
}

impl Corners<f64> for FanPatch {
    type Slopes = Given;

    fn count(&self) -> usize {
        self.corners.len()
    }

    fn slopes(&self, i: usize) -> Given {
        self.corners[i].role.slopes()
    }

    fn weighted<V: Mul<f64, Output = V>>(&self, i: usize, term: V) -> V {
        self.corners[i].role.weighted(term)
    }

    fn total_weight(&self) -> f64 {
        self.corners.iter().map(|corner| corner.role.weighted(1.0)).sum()
    }

    fn quadrilaterals(&self) -> usize {
        self.opposites.len()
    }

    fn quadrilateral(&self, k: usize) -> (usize, Corner<f64>) {
        self.opposites[k]
    }

    fn corner(&self, i: usize, at: [f64; 2]) -> Corner<f64> {
        self.corners[i].seen(at.into(), self.ideal)
    }

    fn pull_back(&self, i: usize, transformed: Dual) -> Dual {
        self.corners[i].map.map_or(transformed, |map| map.pull_back(transformed))
    }

    /// Returns whether a corner is counter-clockwise, by its exact sign and by its rounded area, and has at least the
    /// minimum altitude.
    fn is_positive(&self, i: usize, at: [f64; 2], corner: &Corner<f64>) -> bool {
        let vertices = self.corners[i].vertices(at.into());
        is_positive(&vertices.map(|at| at.to_array()), &[0, 1, 2])
            && corner.doubled_area() > 0.0
            && (self.min_altitude <= 0.0
                || altitude(vertices.map(|at| self.coordinates.at(at))) >= self.min_altitude)
    }
}
