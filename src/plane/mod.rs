//! Meshes whose vertices have three coordinates and lie in one plane of space, of any orientation. Runs move the vertices
//! in the plane.

mod frame;
mod storage;

use std::sync::Arc;
use std::{fmt, iter};

use crate::plane::frame::{Farthest, Frame, Point};
use crate::precision::Precision;
pub(crate) use storage::Storage;

/// Number of bits by which coordinates in space of moved vertices are coarser than double precision has them for the extent of
/// the mesh. Errors of arithmetic are then smaller than the distance between two stored coordinates, so that a stored vertex
/// has a position in the plane that leads back to it.
const COARSENING: u32 = 5;

/// The plane in which the vertices of a mesh lie, with coordinates in the plane.
///
/// In the plane of two axes, the coordinates in the plane have the bits of those in space. In a tilted plane, they are
/// lengths u and v from the mean of all vertices. [`Smoother::set_plane`](crate::Smoother::set_plane) makes runs return positions that
/// the vertices can have in space. A clone shares the vertices.
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
    space: Arc<Vec<Point>>,
    /// The vertices in the plane.
    flat: Arc<Vec<[f64; 2]>>,
    /// See [`rounding`](Plane::rounding).
    rounding: f64,
    /// The number whose addition and subtraction rounds coordinates in space to a common spacing; see [`coarse`]. `None` in the
    /// plane of two axes.
    coarse: Option<f64>,
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
        Ok(Self::with(frame, stored, space))
    }

    /// Returns vertices at other positions, in the coordinates of this plane. The list may have any length.
    pub fn likewise(&self, space: Vec<[f64; 3]>) -> Self {
        Self::with(self.frame, self.stored, space)
    }

    fn with(frame: Frame, stored: Precision, space: Vec<Point>) -> Self {
        let largest = space.as_flattened().iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        // A coordinate in the plane is the product of a direction of length 1 with three rounded coordinates.
        let mut rounding = 2.0 * stored.error(largest);
        let coarse = frame.extent(&space).and_then(|extent| coarse(stored, extent, largest));
        if let Some(coarse) = coarse {
            rounding = rounding.max(f64::EPSILON * coarse);
        }
        let flat = Arc::new(frame.flat(&space));
        Self { frame, stored, space: Arc::new(space), flat, rounding, coarse }
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
    /// so options have no precision for them; [`Smoother::set_plane`](crate::Smoother::set_plane) has.
    pub fn run_precision(&self) -> Precision {
        if self.is_tilted() { Precision::Double } else { self.stored }
    }

    /// Returns a bound on the errors of coordinates in this plane that come from the rounding of coordinates in space. In
    /// the plane of two axes, coordinates have the errors of the file ([`Precision::error`]).
    pub fn rounding(&self) -> f64 {
        self.rounding
    }

    /// Returns x, y and z of the vertices at `points` of the plane. A vertex that has not moved keeps its bits, and so
    /// does the coordinate that is at a right angle to the plane of two axes.
    pub fn in_space(&self, points: &[[f64; 2]]) -> Vec<[f64; 3]> {
        points.iter().enumerate().map(|(v, &point)| self.vertex_in_space(v, point)).collect()
    }

    /// Returns x, y and z of vertex `v` at `point` of the plane, as a file stores them, but for the precision of the file.
    /// Coordinates have the common spacing unless the precision of the file alone leads back to `point`.
    fn vertex_in_space(&self, v: usize, point: [f64; 2]) -> Point {
        let to = self.frame.moved(self.space[v], self.flat[v], point);
        match self.coarse {
            Some(_) if self.has_fine_positions() && self.flat_as_stored(to) == point => to,
            Some(coarse) => self.coarsened(v, to, coarse),
            None => to,
        }
    }

    /// Returns whether positions are sought first at which no coordinate has the common spacing. In double precision, few exist.
    fn has_fine_positions(&self) -> bool {
        !matches!(self.stored, Precision::Double)
    }

    /// Rounds the coordinates in space of vertex `v` that have changed to the common spacing.
    fn coarsened(&self, v: usize, mut to: Point, coarse: f64) -> Point {
        let from = self.space[v];
        for (to, _) in to.iter_mut().zip(from).filter(|(to, from)| **to != *from) {
            *to = (*to + coarse) - coarse;
        }
        to
    }

    /// Returns the position in the plane of a vertex in space whose coordinates are rounded to the precision of the file.
    fn flat_as_stored(&self, at: Point) -> [f64; 2] {
        self.frame.flat_of(&at.map(|x| self.stored.rounded(x)))
    }

    /// Returns a position near `point` at which rounding in space leaves vertex `v`. The coordinates differ by at most
    /// [`rounding`](Self::rounding). If no such position is found, returns the position of the vertex in this plane. Needs a
    /// tilted plane.
    fn settled(&self, v: usize, point: [f64; 2]) -> [f64; 2] {
        /// Number of times that a position is rounded. A rounded vertex is a little beside the plane, and its position in the
        /// plane is rounded to the same vertex or to another, which is nearer to the plane.
        const ROUNDS: usize = 4;
        /// Distances of the positions that are tried beside `point`, in units of [`Plane::rounding`]. Most points need none.
        const BESIDE: [f64; 5] = [0.0, 0.25, -0.25, 0.5, -0.5];
        if self.as_stored(v, point) == point {
            return point;
        }
        let fine = [None].into_iter().filter(|_| self.has_fine_positions());
        for coarse in fine.chain(self.coarse.map(Some)) {
            let stored = |at: [f64; 2]| {
                let to = self.frame.moved(self.space[v], self.flat[v], at);
                self.flat_as_stored(coarse.map_or(to, |coarse| self.coarsened(v, to, coarse)))
            };
            let along = (0..3).map(|axis| self.on_plane(v, point, axis));
            let beside = BESIDE.iter().flat_map(|x| BESIDE.map(|y| [*x, y]));
            let beside = beside.map(|beside| [0, 1].map(|k| point[k] + beside[k] * self.rounding));
            for mut at in iter::once(point).chain(along).chain(beside) {
                for _ in 0..ROUNDS {
                    let next = stored(at);
                    if next == at {
                        break;
                    }
                    at = next;
                }
                let is_near = (0..2).all(|k| (at[k] - point[k]).abs() <= self.rounding);
                if is_near && self.as_stored(v, at) == at {
                    return at;
                }
            }
        }
        self.flat[v]
    }

    /// Returns the position in the plane of vertex `v` at `point` of the plane, after its coordinates in space along two axes
    /// were rounded, and that along `axis` was chosen in the plane and rounded. The finer the numbers along this axis
    /// are, as near zero, the nearer is the vertex to the plane.
    fn on_plane(&self, v: usize, point: [f64; 2], axis: usize) -> [f64; 2] {
        let at = self.frame.moved(self.space[v], self.flat[v], point);
        let mut stored = at.map(|x| self.stored.rounded(x));
        let normal = self.frame.normal();
        let others = (0..3).filter(|&k| k != axis);
        let off = others.map(|k| normal[k] * (stored[k] - at[k])).sum::<f64>();
        stored[axis] = self.stored.rounded(at[axis] - off / normal[axis]);
        self.frame.flat_of(&stored)
    }

    /// Returns the position in the plane of vertex `v` at `point` of the plane, after its coordinates in space were rounded.
    fn as_stored(&self, v: usize, point: [f64; 2]) -> [f64; 2] {
        self.flat_as_stored(self.vertex_in_space(v, point))
    }

    /// Lists the vertices that have left this plane in `after`, another state of the mesh, ascending. In the plane of two
    /// axes, these are the vertices whose third coordinate has other bits.
    pub fn strays(&self, after: &Self) -> Vec<u32> {
        self.frame.strays(&self.space, &after.space, self.stored)
    }
}

/// Returns the number whose addition to a coordinate and subtraction from it rounds the coordinate to the common spacing of
/// vertices in space, for a mesh of this extent with coordinates up to `largest`. `None` if there is no such number.
fn coarse(stored: Precision, extent: f64, largest: f64) -> Option<f64> {
    // The exponent of a number without its mantissa is a power of two.
    let power = |x: f64| f64::from_bits(x.to_bits() & !((1 << (f64::MANTISSA_DIGITS - 1)) - 1));
    let spacing = match stored {
        Precision::Double => {
            let of_extent = power(extent) * f64::from(2u32 << COARSENING);
            f64::EPSILON * of_extent.max(4.0 * power(largest))
        }
        Precision::Single => f64::from(f32::EPSILON) * power(largest),
        Precision::Custom(_) => return None,
    };
    let coarse = 1.5 * spacing / f64::EPSILON;
    (coarse.is_finite() && coarse > f64::MIN_POSITIVE).then_some(coarse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::precision::Rounding;

    /// A former defect: positions in double precision near the origin were rounded again and again, and left their places.
    #[test]
    fn a_settled_position_is_near_the_position_and_is_not_changed_by_rounding() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let short = Rounding {
            name: "short",
            round: |x| format!("{x:.8e}").parse().unwrap(),
            error: |size| 1e-8 * size,
        };
        for trial in 0..300 {
            let stored =
                [Precision::Single, Precision::Double, Precision::Custom(short)][trial % 3];
            // Numbers of texts have no common spacing, so that positions far along one axis alone may not be found.
            let is_text = trial % 3 == 2;
            let off = [0.0, 2.0, 10.0, 30.0, 1e3][trial % 5];
            let (size, off) = [1.0, 1e5, 1e-3].map(|size| (size, off * size))[trial / 5 % 3];
            // Two directions at a right angle, of which some are nearly along an axis.
            let (a, b) = (6.3 * random(), 6.3 * random() * random().powi(trial as i32 % 4));
            let (e, f) = (
                [a.cos(), a.sin() * b.cos(), a.sin() * b.sin()],
                [-a.sin(), a.cos() * b.cos(), a.cos() * b.sin()],
            );
            let at = |[x, y]: [f64; 2]| {
                [0, 1, 2].map(|k| {
                    let along = [[1.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]]
                        [if is_text { 0 } else { trial / 15 % 3 }];
                    stored.rounded(off * along[k] + size * (x * e[k] + y * f[k]))
                })
            };
            let space: Vec<Point> = (0..300)
                .map(|v| {
                    let [x, y] = [random(), random()];
                    // A third of the vertices have a small coordinate in space, if the origin is near.
                    at(if v % 3 == 0 { [-x * f[0] + 1e-9 * y, x * e[0]] } else { [x, y] })
                })
                .collect();
            let plane = Plane::of(space, stored).unwrap();
            if !plane.is_tilted() {
                continue;
            }
            for v in 0..300 {
                assert_eq!(plane.settled(v, plane.flat[v]), plane.flat[v]);
                let far = [0.01, 1.0, 1e-6, 1e-3][v % 4];
                let point = plane.flat[v].map(|x| x + far * size * (random() - 0.5));
                let settled = plane.settled(v, point);
                assert_eq!(plane.settled(v, settled), settled);
                assert_eq!(plane.as_stored(v, settled), settled);
                let off = [0, 1].map(|k| (settled[k] - point[k]).abs());
                assert!(off.iter().all(|&off| off <= plane.rounding()), "{trial} {off:?}");
            }
        }
    }

    #[test]
    fn a_coordinate_that_is_not_finite_is_refused_in_a_tilted_plane() {
        let mut space: Vec<Point> =
            (0..25).map(|i| [f64::from(i % 5), f64::from(i / 5), f64::from(i % 5)]).collect();
        space[7][2] = f64::NAN;
        assert!(Plane::of(space, Precision::Double).unwrap_err().distance.is_nan());
    }
}
