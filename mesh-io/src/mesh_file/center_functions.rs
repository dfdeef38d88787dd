//! Centers of faces and edges, from the coordinates of their corners.

use crate::mesh_file::net_centers::{inner_circumcenter, inner_local_circumcenter, local_centroid};
use crate::mesh_file::plane_centers::{centroid, circumcenter, mean};
use std::ops::RangeInclusive;

/// Function from the corners of an element to its center; `None` if the corners have no such center.
pub(super) type CenterFunction = fn(&[[f64; 2]]) -> Option<[f64; 2]>;

/// The coordinate of centers that an array holds.
#[derive(Clone, Copy)]
pub(super) struct CenterCoordinate {
    /// 0 for x or longitude, 1 for y or latitude.
    pub(super) axis: usize,
    /// Whether coordinates are longitude and latitude in degrees.
    pub(super) is_in_degrees: bool,
}

impl CenterCoordinate {
    /// Returns the functions for the centers that programs store, in the order in which arrays are tested.
    pub(super) fn functions(self) -> &'static [CenterFunction] {
        const LENGTHS: [CenterFunction; 4] = [mean, centroid, circumcenter, inner_circumcenter];
        const DEGREES: [CenterFunction; 7] = [
            |corners| mean(&continued(corners)),
            |corners| centroid(&continued(corners)),
            |corners| circumcenter(&continued(corners)),
            spherical_mean,
            spherical_circumcenter,
            |corners| local_centroid(&continued(corners)),
            |corners| inner_local_circumcenter(&continued(corners)),
        ];
        if self.is_in_degrees { &DEGREES } else { &LENGTHS }
    }

    /// Returns a center that equals `center` up to whole turns, and is nearest to `number`.
    pub(super) fn near(self, center: f64, number: f64) -> f64 {
        match self.is_longitude() {
            true => center + 360.0 * ((number - center) / 360.0).round(),
            false => center,
        }
    }

    /// Returns the range of longitudes of an array, one turn; `None` for other coordinates and longer ranges.
    pub(super) fn range(self, numbers: &[f64]) -> Option<RangeInclusive<f64>> {
        let ranges = [-180.0..=180.0, 0.0..=360.0];
        let fits = |range: &RangeInclusive<f64>| numbers.iter().all(|x| range.contains(x));
        ranges.into_iter().find(fits).filter(|_| self.is_longitude())
    }

    fn is_longitude(self) -> bool {
        self.is_in_degrees && self.axis == 0
    }
}

/// Moves a longitude into a range by one turn, if it is outside.
pub(super) fn within(range: &Option<RangeInclusive<f64>>, longitude: f64) -> f64 {
    match range {
        Some(range) if longitude > *range.end() => longitude - 360.0,
        Some(range) if longitude < *range.start() => longitude + 360.0,
        _ => longitude,
    }
}

/// Continues longitudes across the meridian at which they wrap: each is within half a turn of the first.
fn continued(corners: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let first = corners.first().map_or(0.0, |corner| corner[0]);
    corners.iter().map(|&[x, y]| [x + 360.0 * ((first - x) / 360.0).round(), y]).collect()
}

/// Returns the mean of the corners as points in space, projected onto the sphere. `None` for opposite corners.
fn spherical_mean(corners: &[[f64; 2]]) -> Option<[f64; 2]> {
    let sum = corners
        .iter()
        .map(|&corner| on_sphere(corner))
        .fold([0.0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
    in_degrees(sum)
}

/// Returns the point of the sphere with equal distances from three corners, on their side of the sphere.
fn spherical_circumcenter(corners: &[[f64; 2]]) -> Option<[f64; 2]> {
    let &[a, b, c] = corners else { return None };
    let [a, b, c] = [a, b, c].map(on_sphere);
    let minus = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let (b, c) = (minus(b), minus(c));
    let normal = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
    let side = normal[0] * a[0] + normal[1] * a[1] + normal[2] * a[2];
    in_degrees(normal.map(|x| x * side.signum()))
}

/// Returns the point on the unit sphere at a longitude and a latitude.
fn on_sphere([longitude, latitude]: [f64; 2]) -> [f64; 3] {
    let (sin, cos) = longitude.to_radians().sin_cos();
    let (up, out) = latitude.to_radians().sin_cos();
    [out * cos, out * sin, up]
}

/// Returns longitude and latitude of a direction; `None` for a zero vector.
fn in_degrees([x, y, z]: [f64; 3]) -> Option<[f64; 2]> {
    let out = x.hypot(y);
    (out.hypot(z) > 0.0).then(|| [y.atan2(x).to_degrees(), z.atan2(out).to_degrees()])
}
