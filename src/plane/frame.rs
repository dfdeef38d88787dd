//! Coordinates in the plane of a mesh: the plane of two axes, or a tilted plane.

use crate::precision::Precision;

/// Largest distance of vertices from their plane, relative to the extent of the mesh. Files of six digits round
/// coordinates by up to half of this distance.
const FLATNESS: f64 = 2e-6;

/// A point in space.
pub(crate) type Point = [f64; 3];

/// Coordinates in a plane, made from coordinates in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Frame {
    /// The coordinates of these two axes, with unchanged bits. The third coordinate stays as it is.
    Axes([usize; 2]),
    /// Distances from `origin` along two directions at right angles, both of length 1.
    Tilted { origin: Point, directions: [Point; 2] },
}

/// The vertex that is farthest from a plane.
pub(crate) struct Farthest {
    pub(crate) vertex: usize,
    pub(crate) distance: f64,
}

impl Frame {
    /// Finds the plane in which points lie, up to rounding in a file of this precision.
    ///
    /// # Errors
    /// Returns the point that is farthest from the fitted plane, if that is too far.
    pub(crate) fn of(points: &[Point], stored: Precision) -> Result<Self, Farthest> {
        let tolerance = tolerance(points, stored);
        let range = |axis: usize| {
            let of_axis = points.iter().map(|point| point[axis]);
            let (low, high) = (of_axis.clone().fold(f64::INFINITY, f64::min), of_axis);
            high.fold(f64::NEG_INFINITY, f64::max) - low
        };
        if let Some(vertex) = points.iter().position(|point| !point[2].is_finite()) {
            return Err(Farthest { vertex, distance: f64::NAN });
        }
        let mut axes =
            [(2, [0, 1]), (1, [0, 2]), (0, [1, 2])].map(|(k, others)| (range(k), others));
        // Of equal ranges, the first counts.
        axes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [(least, others), ..] = axes;
        if least <= tolerance {
            return Ok(Self::Axes(others));
        }
        let frame = fitted(points);
        match frame.farthest(points) {
            // The distance is not a number if a coordinate is not finite.
            Some(farthest) if farthest.distance > tolerance || farthest.distance.is_nan() => {
                Err(farthest)
            }
            _ => Ok(frame),
        }
    }

    /// Returns the coordinates of points in the plane.
    pub(crate) fn flat(&self, points: &[Point]) -> Vec<[f64; 2]> {
        points.iter().map(|point| self.flat_of(point)).collect()
    }

    /// Returns the coordinates of a point in the plane.
    pub(crate) fn flat_of(&self, point: &Point) -> [f64; 2] {
        match self {
            Self::Axes(axes) => axes.map(|axis| point[axis]),
            Self::Tilted { origin, directions } => {
                let from = minus(*point, *origin);
                directions.map(|direction| dot(from, direction))
            }
        }
    }

    /// Returns a point in space after its coordinates in the plane have changed from `from` to `to`. A coordinate that
    /// does not change keeps its bits.
    pub(crate) fn moved(&self, point: Point, from: [f64; 2], to: [f64; 2]) -> Point {
        let mut moved = point;
        match self {
            Self::Axes(axes) => (0..2).for_each(|k| moved[axes[k]] = to[k]),
            Self::Tilted { directions: [e, f], .. } => {
                let by = [to[0] - from[0], to[1] - from[1]];
                if from.map(f64::to_bits) != to.map(f64::to_bits) {
                    (0..3).for_each(|k| moved[k] += by[0] * e[k] + by[1] * f[k]);
                }
            }
        }
        moved
    }

    /// Returns the largest coordinate of points, counted from the origin of a tilted plane. `None` in the plane of two axes.
    pub(crate) fn extent(&self, points: &[Point]) -> Option<f64> {
        let Self::Tilted { origin, .. } = self else { return None };
        let from_origin = points.iter().flat_map(|&point| minus(point, *origin));
        Some(from_origin.fold(0.0, |most: f64, x| most.max(x.abs())))
    }

    /// Returns the direction at a right angle to the plane.
    pub(crate) fn normal(&self) -> Point {
        match self {
            Self::Axes(axes) => [0, 1, 2].map(|k| f64::from(u8::from(!axes.contains(&k)))),
            Self::Tilted { directions: [e, f], .. } => cross(*e, *f),
        }
    }

    /// Returns the point that is farthest from a tilted plane; `None` without points.
    fn farthest(&self, points: &[Point]) -> Option<Farthest> {
        let Self::Tilted { origin, .. } = self else { return None };
        let normal = self.normal();
        let distances = points.iter().map(|&point| dot(minus(point, *origin), normal).abs());
        let farthest = distances.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        farthest.map(|(vertex, distance)| Farthest { vertex, distance })
    }

    /// Lists the points that have left the plane of `before`, by twice the tolerance of planes. In the plane of two axes,
    /// these are the points with another third coordinate.
    pub(crate) fn strays(&self, before: &[Point], after: &[Point], stored: Precision) -> Vec<u32> {
        let tolerance = 2.0 * tolerance(before, stored);
        let normal = self.normal();
        let strays = |(old, new): (&Point, &Point)| match self {
            Self::Axes(axes) => {
                (0..3).any(|k| !axes.contains(&k) && old[k].to_bits() != new[k].to_bits())
            }
            Self::Tilted { .. } => dot(minus(*new, *old), normal).abs() > tolerance,
        };
        (0..)
            .zip(before.iter().zip(after))
            .filter(|&(_, pair)| strays(pair))
            .map(|(v, _)| v)
            .collect()
    }
}

/// Returns the distance from a plane up to which points count as points of the plane.
fn tolerance(points: &[Point], stored: Precision) -> f64 {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in points {
        for k in 0..3 {
            (low[k], high[k]) = (low[k].min(point[k]), high[k].max(point[k]));
        }
    }
    let extent = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    let largest = (0..3).map(|k| high[k].abs().max(low[k].abs())).fold(0.0, f64::max);
    FLATNESS * extent + 2.0 * stored.error(largest)
}

/// Fits a plane to points: first through three points far apart, then by least squares of the distances.
fn fitted(points: &[Point]) -> Frame {
    let count = points.len().max(1) as f64;
    let mean = [0, 1, 2].map(|k| points.iter().map(|point| point[k] / count).sum::<f64>());
    let farthest = |size: &dyn Fn(Point) -> f64| {
        let all = points.iter().map(|&point| minus(point, mean));
        all.max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or_default()
    };
    let first = unit(farthest(&|from| dot(from, from)));
    let second = farthest(&|from| {
        let off = cross(first, from);
        dot(off, off)
    });
    let mut normal = unit(cross(first, second));
    let mut frame = with_normal(mean, normal);
    // The distances w are fitted by a u + b v, and the normal is turned by the small slopes a and b. One step suffices:
    // the error of the first normal enters by its square.
    if let Frame::Tilted { directions: [e, f], .. } = frame {
        let (mut uu, mut uv, mut vv, mut uw, mut vw) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for &point in points {
            let from = minus(point, mean);
            let (u, v, w) = (dot(from, e), dot(from, f), dot(from, normal));
            (uu, uv, vv) = (uu + u * u, uv + u * v, vv + v * v);
            (uw, vw) = (uw + u * w, vw + v * w);
        }
        let determinant = uu * vv - uv * uv;
        let (a, b) = ((uw * vv - vw * uv) / determinant, (vw * uu - uw * uv) / determinant);
        if a.is_finite() && b.is_finite() {
            normal = unit([0, 1, 2].map(|k| normal[k] - a * e[k] - b * f[k]));
            frame = with_normal(mean, normal);
        }
    }
    frame
}

/// Returns coordinates in the plane through `origin` with this normal. The first direction is the projection of the
/// axis that is nearest to the plane.
fn with_normal(origin: Point, normal: Point) -> Frame {
    let steepest = |a: &usize, b: &usize| normal[*a].abs().total_cmp(&normal[*b].abs());
    let axis = (0..3).min_by(steepest).unwrap_or(0);
    let along = [0, 1, 2].map(|k| f64::from(u8::from(k == axis)) - normal[axis] * normal[k]);
    let first = unit(along);
    Frame::Tilted { origin, directions: [first, cross(normal, first)] }
}

fn minus(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: Point) -> Point {
    // The square of very long or very short vectors leaves the range of f64.
    let largest = a.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let scaled = a.map(|x| x / largest);
    let length = dot(scaled, scaled).sqrt();
    scaled.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_of_two_axes_keep_the_bits_of_coordinates() {
        let points = [[0.1, 7.0, 0.3], [1.0, 7.0, 0.0], [0.5, 7.0, 1.7]];
        let frame = Frame::of(&points, Precision::Double).ok().unwrap();
        assert_eq!(frame, Frame::Axes([0, 2]));
        assert_eq!(frame.flat(&points), [[0.1, 0.3], [1.0, 0.0], [0.5, 1.7]]);
        assert_eq!(frame.moved(points[0], [0.1, 0.3], [0.2, -0.4]), [0.2, 7.0, -0.4]);
        let lifted = [[0.1, 7.0, 0.3], [1.0, 7.5, 0.0], [0.5, 7.0, 1.7]];
        assert_eq!(frame.strays(&points, &lifted, Precision::Double), [1]);
    }

    #[test]
    fn lengths_in_a_tilted_plane_are_lengths_in_space() {
        let plane = |x: f64, y: f64| [x + 3e5, y, 0.5 * x - 2.0 * y + 1.0];
        let points: Vec<Point> =
            (0..30).map(|i| plane(f64::from(i % 6) * 0.7, f64::from(i / 6) + 0.1)).collect();
        let frame = Frame::of(&points, Precision::Double).ok().unwrap();
        let flat = frame.flat(&points);
        for (i, a) in points.iter().enumerate() {
            let (off, flat) = (minus(*a, points[0]), [0, 1].map(|k| flat[i][k] - flat[0][k]));
            let (space, plane) = (dot(off, off).sqrt(), flat[0].hypot(flat[1]));
            assert!((space - plane).abs() < 1e-9, "{space} {plane}");
        }
        assert_eq!(frame.moved(points[3], flat[3], flat[3]), points[3]);
        let moved = frame.moved(points[3], flat[3], [flat[3][0] + 1.0, flat[3][1] - 2.0]);
        assert!(frame.strays(&points[3..4], &[moved], Precision::Double).is_empty());
    }

    /// A former defect: the first axis within the tolerance was taken, which is large far from the origin.
    #[test]
    fn the_axis_of_the_least_range_is_at_a_right_angle_to_the_plane() {
        let points = [[1e7, 0.0, 0.0], [1e7, 2.0, 0.0], [1e7, 2.0, 2.0], [1e7, 0.0, 2.0]];
        assert_eq!(Frame::of(&points, Precision::Single).ok(), Some(Frame::Axes([1, 2])));
        let infinite = points.map(|[x, y, z]| [x, y, if z == 0.0 { z } else { f64::INFINITY }]);
        assert_eq!(Frame::of(&infinite, Precision::Double).err().unwrap().vertex, 2);
    }

    #[test]
    fn points_off_a_plane_are_named() {
        let mut points: Vec<Point> =
            (0..25).map(|i| [f64::from(i % 5), f64::from(i / 5), f64::from(i % 5)]).collect();
        points[7][2] += 0.5;
        let farthest = Frame::of(&points, Precision::Double).err().unwrap();
        assert_eq!(farthest.vertex, 7);
        assert!((0.2..0.4).contains(&farthest.distance), "{}", farthest.distance);
    }
}
