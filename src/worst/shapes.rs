//! The worst shapes among the triangles of a mesh, in the coordinates as they are stored.

use fearless_simd::prelude::*;

use crate::patch::lanes::LANES;
use crate::patch::{FourTriangles, dot};
use crate::targets::Surface;
use crate::topology::predicates::orientation;

/// 2√3: a triangle's inverse mean ratio is the sum of its squared edge lengths, divided by 2√3 times twice its area.
const TWO_SQRT_3: f64 = 3.464_101_615_137_754_6;

/// Cotangent of 60 degrees. Larger angles of quadrilaterals are not small: a triangle has no larger smallest angle, and rectangles
/// of unequal sides become better by their inverse mean ratios only if their right angles change.
const NO_SMALL_ANGLE: f64 = 0.577_350_269_189_625_8;

/// Share by which a shape may be beyond a limit. On a regular mesh, a vertex may have to stay on a straight line, which
/// penalties approach only up to rounding. The least angle of right isosceles triangles may fall by 3e-8 degrees.
const ROUNDING: f64 = 1e-9;

/// The worst angle and the worst inverse mean ratio of some triangles. Both numbers rise as triangles become flat, and are
/// infinite if a triangle is inverted or flat by exact predicates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WorstShapes {
    /// Cotangent of the smallest angle.
    pub(crate) cotangent: f64,
    /// Largest inverse mean ratio.
    pub(crate) imr: f64,
}

impl WorstShapes {
    /// The worst shapes of an empty list of triangles.
    pub(crate) const NONE: Self = Self { cotangent: f64::NEG_INFINITY, imr: 0.0 };

    const FLAT: Self = Self { cotangent: f64::INFINITY, imr: f64::INFINITY };

    /// Returns the shape of a corner with vertices at `points`, as seen on `surface`. Corners of quadrilaterals, for which
    /// `is_right` is true, are judged by their first angle alone.
    #[inline]
    pub(crate) fn of(
        surface: Surface,
        points: &[[f64; 2]],
        corner: &[u32; 3],
        is_right: bool,
    ) -> Self {
        let Products { dots, squares, sides, doubled_area } = Products::of(surface, points, corner);
        if is_right {
            let imr = sides / (2.0 * doubled_area);
            let cotangent = (dots[0] / doubled_area).max(NO_SMALL_ANGLE);
            return if doubled_area > 0.0 && imr > 0.0 {
                Self { cotangent, imr }
            } else {
                Self::FLAT
            };
        }
        let most = dots[0].max(dots[1]).max(dots[2]);
        let (cotangent, imr) = (most / doubled_area, squares / (TWO_SQRT_3 * doubled_area));
        // The comparisons are false for NaN.
        match doubled_area > 0.0 && cotangent > 0.0 && imr > 0.0 {
            true => Self { cotangent, imr },
            false => Self::FLAT,
        }
    }

    /// Adds four triangles, with the bits of [`of`](Self::of). `counts` returns whether the triangle in a lane counts.
    #[inline(always)]
    pub(crate) fn add_four<S: Simd>(
        &mut self,
        four: &FourTriangles<S>,
        counts: impl Fn(usize) -> bool,
    ) {
        let &FourTriangles { a, b, c, doubled_area } = four;
        let (u, v, w) = (dot(a, b), -dot(a, c), dot(b, c));
        let squares = dot(a, a) + dot(b, b) + dot(c, c);
        let (cotangent, imr) =
            (u.max(v).max(w) / doubled_area, squares / (doubled_area * TWO_SQRT_3));
        let is_worse = cotangent.simd_gt(self.cotangent) | imr.simd_gt(self.imr);
        if is_worse.all_false() {
            return;
        }
        for lane in (0..LANES).filter(|&lane| counts(lane)) {
            *self = self.and(Self { cotangent: cotangent[lane], imr: imr[lane] });
        }
    }

    /// Returns the cotangent of the largest angle of a triangle with vertices at `points`, as seen on `surface`. Negative
    /// infinity if the triangle is inverted or flat.
    pub(crate) fn least_cotangent(
        surface: Surface,
        points: &[[f64; 2]],
        triangle: &[u32; 3],
    ) -> f64 {
        let Products { dots, doubled_area, .. } = Products::of(surface, points, triangle);
        match doubled_area > 0.0 {
            true => dots[0].min(dots[1]).min(dots[2]) / doubled_area,
            false => f64::NEG_INFINITY,
        }
    }

    /// Returns whether the worst inverse mean ratio is no larger than that of other triangles, up to [`ROUNDING`].
    pub(crate) fn has_imr_of(self, other: Self) -> bool {
        self.imr <= other.imr * (1.0 + ROUNDING)
    }

    /// Returns the worst shapes of the triangles of two lists.
    #[inline]
    pub(crate) fn and(self, other: Self) -> Self {
        Self { cotangent: self.cotangent.max(other.cotangent), imr: self.imr.max(other.imr) }
    }

    /// Returns whether neither the angle nor the inverse mean ratio is worse than that of `limit`, up to rounding.
    #[inline]
    pub(crate) fn is_within(self, limit: Self) -> bool {
        const MOST: f64 = 1.0 + ROUNDING;
        self.cotangent <= limit.cotangent * MOST && self.imr <= limit.imr * MOST
    }

    /// Returns the smallest angle in degrees.
    pub(crate) fn least_angle(self) -> f64 {
        1f64.atan2(self.cotangent).to_degrees()
    }
}

/// Products of the edges of a triangle.
struct Products {
    /// For each angle, the scalar product of its two edges.
    dots: [f64; 3],
    /// Sum of the squared edge lengths.
    squares: f64,
    /// Sum of the squared lengths of the two edges at the first vertex.
    sides: f64,
    /// Twice the signed area.
    doubled_area: f64,
}

impl Products {
    #[inline]
    fn of(surface: Surface, points: &[[f64; 2]], triangle: &[u32; 3]) -> Self {
        let [x, y] = surface.lengths_in(points, triangle);
        let doubled_area = orientation(points, triangle) * x * y;
        let [p, q, r] = triangle.map(|v| points[v as usize]);
        let to = |from: [f64; 2], to: [f64; 2]| [(to[0] - from[0]) * x, (to[1] - from[1]) * y];
        let dot = |u: [f64; 2], v: [f64; 2]| u[0] * v[0] + u[1] * v[1];
        let (a, b, c) = (to(p, q), to(p, r), to(q, r));
        let sides = dot(a, a) + dot(b, b);
        let squares = sides + dot(c, c);
        Self { dots: [dot(a, b), -dot(a, c), dot(b, c)], squares, sides, doubled_area }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(points: [[f64; 2]; 3]) -> WorstShapes {
        WorstShapes::of(Surface::Plane, &points, &[0, 1, 2], false)
    }

    #[test]
    fn shapes_are_those_of_known_triangles() {
        let right = shape([[7.0, 3.0], [9.0, 3.0], [7.0, 5.0]]);
        assert!((right.least_angle() - 45.0).abs() < 1e-13, "{right:?}");
        assert!((right.imr - 2.0 / 3f64.sqrt()).abs() < 1e-14, "{right:?}");
        let half = 0.5 * 3f64.sqrt();
        let equilateral = shape([[0.0, 0.0], [1.0, 0.0], [0.5, half]]);
        assert!((equilateral.least_angle() - 60.0).abs() < 1e-13, "{equilateral:?}");
        assert!((equilateral.imr - 1.0).abs() < 1e-15, "{equilateral:?}");
        // At a latitude of 60 degrees, a degree of longitude is half as long as a degree of latitude.
        let turn = [[0.0, 60.0], [2.0, 60.0], [0.0, 61.0]].map(|[x, y]| [x, y - 1.0 / 3.0]);
        let seen = WorstShapes::of(Surface::Sphere, &turn, &[0, 1, 2], false);
        assert!((seen.least_angle() - 45.0).abs() < 1e-9, "{seen:?}");
    }

    #[test]
    fn a_flat_inverted_or_infinite_triangle_is_the_worst() {
        for p in [[0.5, 0.0], [0.5, -1.0], [f64::NAN, 1.0], [f64::INFINITY, 1.0]] {
            let flat = shape([[0.0, 0.0], [1.0, 0.0], p]);
            assert_eq!(flat, WorstShapes::FLAT, "{p:?}");
            assert!(!flat.is_within(shape([[0.0, 0.0], [1.0, 0.0], [0.5, 1e-9]])));
        }
        assert!(WorstShapes::FLAT.is_within(WorstShapes::FLAT));
    }

    #[test]
    fn either_shape_may_be_the_worse() {
        let flat = shape([[0.0, 0.0], [2.0, 0.0], [1.0, 0.3]]);
        let thin = shape([[0.0, 0.0], [0.4, 0.0], [0.2, 1.6]]);
        let both = flat.and(thin);
        assert!(both.is_within(both) && flat.is_within(both) && thin.is_within(both));
        assert!(flat.imr > thin.imr && flat.cotangent < thin.cotangent);
        let worse = WorstShapes { imr: both.imr * (1.0 + 1e-8), ..both };
        assert!(!worse.is_within(both));
        let worse = WorstShapes { cotangent: both.cotangent * (1.0 + 1e-8), ..both };
        assert!(!worse.is_within(both));
        assert!(WorstShapes::NONE.is_within(both));
    }
}
