//! Meshes whose vertices have three coordinates and lie in one plane of space, of any orientation. Runs move the vertices
//! in the plane.

mod frame;

use std::fmt;

use crate::error::MeshError;
use crate::front_ends::plane::frame::{Farthest, Frame, Point};
use crate::options::Options;
use crate::precision::Precision;
use crate::topology::{Topology, certify};
use crate::whole::altitude::{self, Limits};

/// The plane in which the vertices of a mesh lie, with coordinates in the plane.
///
/// In the plane of two axes, the coordinates in the plane have the bits of those in space. In a tilted plane, they are
/// lengths u and v from the mean of all vertices.
///
/// ```
/// use gpu_smooth::{front_ends::Plane, options::Precision};
///
/// // A square in the plane of x and z.
/// let space = vec![[0.0, 7.0, 0.0], [2.0, 7.0, 0.0], [2.0, 7.0, 2.0], [0.0, 7.0, 2.0], [1.5, 7.0, 1.25]];
/// let plane = Plane::of(space, Precision::Double)?;
/// assert_eq!(plane.axes(), ["x", "z"]);
/// let mut points = plane.points().to_vec();
/// assert_eq!(points[4], [1.5, 1.25]);
/// points[4] = [1.0, 1.0];
/// assert_eq!(plane.in_space(&points)[4], [1.0, 7.0, 1.0]);
/// # Ok::<(), gpu_smooth::front_ends::NotPlanar>(())
/// ```
#[derive(Clone, Debug)]
pub struct Plane {
    frame: Frame,
    /// Precision in which the coordinates in space are stored.
    stored: Precision,
    /// The vertices in space.
    space: Vec<Point>,
    /// The vertices in the plane.
    flat: Vec<[f64; 2]>,
}

/// The error of vertices that do not lie in one plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NotPlanar {
    /// The vertex that is farthest from the plane nearest to all vertices.
    pub vertex: usize,
    /// Distance of the vertex from this plane. Not finite if a coordinate is not finite.
    pub distance: f64,
}

impl fmt::Display for NotPlanar {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { vertex, distance } = self;
        write!(
            f,
            "the mesh is not planar: vertex {vertex} is at a distance of {distance} from the plane nearest to all vertices"
        )
    }
}

impl std::error::Error for NotPlanar {}

impl Plane {
    /// Finds the plane in which vertices lie, up to 2e-6 of the extent of the mesh and the rounding of numbers that are
    /// stored in the precision `stored`.
    ///
    /// # Errors
    /// [`NotPlanar`] if a vertex is farther from the plane.
    pub fn of(space: Vec<[f64; 3]>, stored: Precision) -> Result<Self, NotPlanar> {
        let frame = Frame::of(&space, stored)
            .map_err(|Farthest { vertex, distance }| NotPlanar { vertex, distance })?;
        let flat = frame.flat(&space);
        Ok(Self { frame, stored, space, flat })
    }

    /// Returns vertices at other positions, in the coordinates of this plane. The list may have any length.
    pub fn likewise(&self, space: Vec<[f64; 3]>) -> Self {
        let flat = self.frame.flat(&space);
        Self { frame: self.frame, stored: self.stored, space, flat }
    }

    /// Returns the vertices in the plane.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.flat
    }

    /// Returns whether the plane is that of x and y.
    pub fn is_of_xy(&self) -> bool {
        self.frame == Frame::Axes([0, 1])
    }

    /// Returns whether the plane is tilted. Coordinates in the plane are then no coordinates in space.
    pub fn is_tilted(&self) -> bool {
        matches!(self.frame, Frame::Tilted { .. })
    }

    /// Returns the names of the two coordinates in the plane: two of x, y and z, or u and v in a tilted plane.
    pub fn axes(&self) -> [&'static str; 2] {
        match self.frame {
            Frame::Axes(axes) => axes.map(|axis| ["x", "y", "z"][axis]),
            Frame::Tilted { .. } => ["u", "v"],
        }
    }

    /// Returns the unit vector at a right angle to the plane.
    pub fn normal(&self) -> [f64; 3] {
        self.frame.normal()
    }

    /// Returns the precision to which a run rounds coordinates in the plane. Coordinates in a tilted plane are not stored,
    /// so a run does not round them: see [`certify_as_stored`](Self::certify_as_stored).
    pub fn run_precision(&self) -> Precision {
        if self.is_tilted() { Precision::Double } else { self.stored }
    }

    /// Returns a bound on the errors of coordinates in this plane that come from the rounding of coordinates in space. In
    /// the plane of two axes, coordinates have the errors of the file ([`Precision::error`]).
    pub fn rounding(&self) -> f64 {
        let largest = self.space.as_flattened().iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        // A coordinate in the plane is the product of a direction of length 1 with three rounded coordinates.
        2.0 * self.stored.error(largest)
    }

    /// Returns x, y and z of the vertices at `points` of the plane. A vertex that has not moved keeps its bits, and so
    /// does the coordinate that is at a right angle to the plane of two axes.
    pub fn in_space(&self, points: &[[f64; 2]]) -> Vec<[f64; 3]> {
        let from = self.space.iter().zip(&self.flat);
        from.zip(points).map(|((&at, &from), &to)| self.frame.moved(at, from, to)).collect()
    }

    /// Moves vertices in a tilted plane to where they are once their coordinates in space are rounded, and sets vertices back
    /// until no triangle is inverted there, nor breaks [`Options::keep_altitude`]. `before` are the vertices before the run.
    /// Does nothing in the plane of two axes, in which a run itself rounds coordinates.
    ///
    /// # Errors
    /// Returns the errors of [`certify`], for the positions after rounding.
    pub fn certify_as_stored(
        &self,
        topology: &Topology<'_>,
        before: &[[f64; 2]],
        points: &mut [[f64; 2]],
        options: &Options,
    ) -> Result<(), MeshError> {
        if !self.is_tilted() {
            return Ok(());
        }
        let mut old = before.to_vec();
        self.settle(&mut old);
        loop {
            self.settle(points);
            let stored = self.as_stored(points);
            let mut certified = stored.clone();
            certify(topology, &old, &mut certified)?;
            while options.keep_altitude
                && altitude::restore(topology, &old, &mut certified, Limits::ALTITUDE) > 0
            {
                certify(topology, &old, &mut certified)?;
            }
            let is_bad = |&v: &usize| stored[v] != certified[v];
            let bad: Vec<usize> = (0..points.len()).filter(is_bad).collect();
            if bad.is_empty() {
                return Ok(());
            }
            if bad.iter().all(|&v| points[v] == old[v]) {
                points.copy_from_slice(before);
                return Ok(());
            }
            bad.into_iter().for_each(|v| points[v] = old[v]);
        }
    }

    /// Moves vertices in a tilted plane to the nearest positions that rounding in space does not change. A rounded vertex is a
    /// little beside the plane, and its position in the plane is rounded to the same vertex or to another, which is nearer to the
    /// plane. So a few rounds suffice.
    fn settle(&self, points: &mut [[f64; 2]]) {
        /// Number of rounds. In double precision, the last bits of positions may change without end.
        const ROUNDS: usize = 16;
        for _ in 0..ROUNDS {
            let stored = self.as_stored(points);
            if points == stored {
                return;
            }
            points.copy_from_slice(&stored);
        }
    }

    /// Returns the positions in the plane of vertices at `points` of the plane, after their coordinates in space were
    /// rounded.
    fn as_stored(&self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mut space = self.in_space(points);
        space.as_flattened_mut().iter_mut().for_each(|x| *x = self.stored.rounded(*x));
        self.frame.flat(&space)
    }

    /// Lists the vertices that have left this plane in `after`, another state of the mesh, ascending. In the plane of two
    /// axes, these are the vertices whose third coordinate has other bits.
    pub fn strays(&self, after: &Self) -> Vec<u32> {
        self.frame.strays(&self.space, &after.space, self.stored)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Change;
    use crate::mesh::Mesh;

    #[test]
    fn rounding_to_single_precision_keeps_bounds_and_changes_no_certified_point() {
        // A tilted square of size 0.1 far from the origin, where single precision has steps of 0.008.
        let corners = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1], [0.05, 0.05]];
        let space = corners.map(|[x, y]| {
            [x + 1e5, y - 1e5, 0.75 * x + 0.5 * y + 1e5].map(|x| f64::from(x as f32))
        });
        let plane = Plane::of(space.to_vec(), Precision::Single).unwrap();
        assert!(plane.is_tilted() && plane.run_precision() == Precision::Double);
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let mesh = Mesh { points: plane.points().to_vec(), triangles, ..Mesh::default() };
        let topology = Topology::new(&mesh).unwrap();
        let is_valid = |points: &[[f64; 2]]| topology.bad_triangles(points).unwrap().is_empty();
        let (mut returned, mut kept, mut settled) = (0, 0, 0);
        let least_altitude = |points: &[[f64; 2]]| {
            Change::between(&topology, &mesh.points, points).unwrap().least_altitude
        };
        for step in 0..1600 {
            // Near the edge between vertices 0 and 3, at 40 places along it.
            let (share, along) =
                (0.9 + 0.0025 * f64::from(step % 40), (f64::from(step / 40) + 0.5) / 40.0);
            let mut points = mesh.points.clone();
            let ([a, b], middle) = ([points[0], points[3]], points[4]);
            points[4] = [0, 1].map(|k| {
                let edge = (1.0 - along) * a[k] + along * b[k];
                middle[k] + share * (edge - middle[k])
            });
            assert!(is_valid(&points), "{step}");
            let mut given = points.clone();
            plane.settle(&mut given);
            settled += usize::from(given != plane.as_stored(&points));
            assert_eq!(plane.as_stored(&given), given, "{step}");
            for keep_altitude in [false, true] {
                let options = Options { keep_altitude, ..Options::default() };
                let mut points = points.clone();
                plane.certify_as_stored(&topology, &mesh.points, &mut points, &options).unwrap();
                assert!(is_valid(&points), "{step}");
                // The points are those of the written file.
                assert_eq!(plane.as_stored(&points), points, "{step}");
                let [before, after] = least_altitude(&given);
                let may_stay = is_valid(&given) && (!keep_altitude || after >= before);
                assert_eq!(points[4], if may_stay { given[4] } else { mesh.points[4] }, "{step}");
                *if may_stay { &mut kept } else { &mut returned } += 1;
            }
        }
        assert!(returned > 1600 && kept > 100, "{returned} {kept}");
        assert!(settled > 0);
    }

    #[test]
    fn a_coordinate_that_is_not_finite_is_refused_in_a_tilted_plane() {
        let mut space: Vec<Point> =
            (0..25).map(|i| [f64::from(i % 5), f64::from(i / 5), f64::from(i % 5)]).collect();
        space[7][2] = f64::NAN;
        assert!(Plane::of(space, Precision::Double).unwrap_err().distance.is_nan());
    }
}
