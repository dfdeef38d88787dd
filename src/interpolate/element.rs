//! Elements of a mesh as convex polygons, and the interpolation of vertex data within them: linear in a triangle, bilinear in a
//! quadrilateral.

use crate::mesh::Element;
use crate::topology::Topology;
use crate::topology::predicates::orientation;

/// The vertices of an element, counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub(super) enum Cell {
    Triangle([u32; 3]),
    Quadrilateral([u32; 4]),
}

/// A point of an element.
#[derive(Clone, Copy, Debug)]
pub(super) enum LocatedPoint {
    /// The point a + (b - a) `weights[0]` + (c - a) `weights[1]` of a triangle a, b, c.
    OfTriangle { corners: [u32; 3], weights: [f64; 2] },
    /// The point of a quadrilateral a, b, c, d that is at the place (u, v) = `at` of the unit square, by the bilinear map of the
    /// square: (1 - u)(1 - v) a + u (1 - v) b + u v c + (1 - u) v d.
    OfQuadrilateral { corners: [u32; 4], at: [f64; 2] },
}

impl Cell {
    /// Returns the element of a corner.
    pub(super) fn of(topology: &Topology<'_>, corner: u32) -> Self {
        let corners = topology.corner_list();
        match corners.element(corner) {
            Element::Triangle(index) => Self::Triangle(corners.triangles()[index]),
            Element::Quadrilateral(index) => Self::Quadrilateral(corners.quadrilateral(index)),
        }
    }

    pub(super) fn vertices(&self) -> &[u32] {
        match self {
            Self::Triangle(corners) => corners,
            Self::Quadrilateral(corners) => corners,
        }
    }

    /// Returns the side from the vertex `k` to the next, cyclically.
    pub(super) fn side(&self, k: usize) -> [u32; 2] {
        let vertices = self.vertices();
        [vertices[k % vertices.len()], vertices[(k + 1) % vertices.len()]]
    }

    pub(super) fn sides(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        (0..self.vertices().len()).map(|k| self.side(k))
    }

    /// Returns the element as the location of a point. If rounding has put the point outside, it is moved to the boundary.
    pub(super) fn located(&self, points: &[[f64; 2]], place: [f64; 2]) -> LocatedPoint {
        match *self {
            Self::Triangle(corners) => {
                let [a, b, c] = corners.map(|vertex| points[vertex as usize]);
                let area = |corners: [[f64; 2]; 3]| orientation(&corners, &[0, 1, 2]);
                let share = |part: f64| (part / area([a, b, c])).clamp(0.0, 1.0);
                let mut weights = [share(area([a, place, c])), share(area([a, b, place]))];
                let sum = weights[0] + weights[1];
                if sum > 1.0 {
                    weights = weights.map(|weight| weight / sum);
                }
                LocatedPoint::OfTriangle { corners, weights }
            }
            Self::Quadrilateral(corners) => {
                let at = inverse_bilinear(corners.map(|vertex| points[vertex as usize]), place);
                LocatedPoint::OfQuadrilateral { corners, at }
            }
        }
    }
}

impl LocatedPoint {
    /// Returns the value at the point, given the values `of` vertices. If all values are equal, the result has their bits. NaN if a
    /// value is not finite.
    pub(super) fn value(&self, of: impl Fn(u32) -> f64) -> f64 {
        match *self {
            Self::OfTriangle { corners, weights } => linear(corners.map(of), weights),
            Self::OfQuadrilateral { corners, at } => bilinear(corners.map(of), at),
        }
    }
}

/// Interpolates linearly between three values.
fn linear([a, b, c]: [f64; 3], [to_b, to_c]: [f64; 2]) -> f64 {
    if ![a, b, c].iter().all(|value| value.is_finite()) {
        return f64::NAN;
    }
    // The differences are halved, as the difference of two large numbers may overflow.
    let value = a + 2.0 * (to_b * (0.5 * b - 0.5 * a) + to_c * (0.5 * c - 0.5 * a));
    value.clamp(a.min(b).min(c), a.max(b).max(c))
}

/// Interpolates bilinearly between four values.
fn bilinear([a, b, c, d]: [f64; 4], [u, v]: [f64; 2]) -> f64 {
    let side = |from: f64, to: f64| linear([from, to, from], [u, 0.0]);
    let [low, high] = [side(a, b), side(d, c)];
    linear([low, high, low], [v, 0.0])
}

/// Number of steps of Newton's method for the inverse of a bilinear map. Ten suffice in all but nearly triangular quadrilaterals.
const STEPS: usize = 40;

/// Returns the place in the unit square that the bilinear map to a convex quadrilateral maps to a point, by Newton's method from
/// the center. The map is invertible on the square, as its Jacobian is between those of the corners.
fn inverse_bilinear([a, b, c, d]: [[f64; 2]; 4], place: [f64; 2]) -> [f64; 2] {
    let minus = |p: [f64; 2], q: [f64; 2]| [p[0] - q[0], p[1] - q[1]];
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let (along, up, to) = (minus(b, a), minus(d, a), minus(place, a));
    let bent = minus(minus(c, d), along);
    let mut at = [0.5; 2];
    for _ in 0..STEPS {
        let [u, v] = at;
        let by_u = [0, 1].map(|k| along[k] + v * bent[k]);
        let by_v = [0, 1].map(|k| up[k] + u * bent[k]);
        let left = [0, 1].map(|k| to[k] - u * along[k] - v * up[k] - u * v * bent[k]);
        let area = cross(by_u, by_v);
        let step = [cross(left, by_v) / area, cross(by_u, left) / area];
        // Inside of the square, the Jacobian is positive.
        let next = [0, 1].map(|k| (at[k] + step[k]).clamp(0.0, 1.0));
        if next == at || !next.iter().all(|x| x.is_finite()) {
            break;
        }
        at = next;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_of_convex_quadrilaterals_are_found_again() {
        let quadrilaterals = [
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            [[0.0, 0.0], [4.0, 0.1], [3.0, 2.0], [0.2, 1.0]],
            // Nearly triangles: a corner of almost 180 degrees, and a short side.
            [[0.0, 0.0], [2.0, 0.0], [1.01, 1.01], [0.0, 2.0]],
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1e-3], [0.0, 1.0]],
            [[500_000.0, 4e6], [500_100.0, 4e6], [500_090.0, 4e6 + 0.3], [500_003.0, 4e6 + 0.2]],
        ];
        for corners in quadrilaterals {
            for k in 0..121 {
                let at = [f64::from(k % 11) / 10.0, f64::from(k / 11) / 10.0];
                let place = [0, 1].map(|axis| bilinear(corners.map(|p| p[axis]), at));
                let found = inverse_bilinear(corners, place);
                let again = [0, 1].map(|axis| bilinear(corners.map(|p| p[axis]), found));
                let size = corners.as_flattened().iter().fold(0.0f64, |size, x| size.max(x.abs()));
                let off = (again[0] - place[0]).hypot(again[1] - place[1]);
                assert!(off <= 1e-13 * size, "{corners:?} {at:?}: {found:?}, {off:e}");
            }
        }
    }

    #[test]
    fn equal_values_keep_their_bits_and_values_stay_between_those_of_the_vertices() {
        let tenth = 0.1f64;
        assert_eq!(bilinear([tenth; 4], [0.3, 0.7]).to_bits(), tenth.to_bits());
        assert_eq!(bilinear([0.0, 1.0, 3.0, 2.0], [0.25, 0.5]), 1.25);
        assert!(bilinear([1.0, f64::NAN, 1.0, 1.0], [0.0, 0.0]).is_nan());
    }
}
