//! The badness of triangles: the squared measure by which the worst triangles are found and improved.

use glam::DVec2;

use crate::layout::{MeshCoordinates, Problem};
use crate::metric::{Corner, Dual, EdgeSlopes, Given, Ideal, Real};
use crate::options::WorstBy;
use crate::patch::{FanCorner, FanPatch};
use crate::topology::predicates::is_positive;

/// √3/6: twice the area of an equilateral triangle, divided by the sum of its squared edge lengths.
const IDEAL: f64 = 0.288_675_134_594_812_9;

/// A squared measure of triangles, larger for worse ones: the inverse mean ratio, 1 / sine of the smallest angle, or 1
/// / smallest altitude. The squares have smooth derivatives.
#[derive(Clone, Copy)]
pub(crate) struct Badness(pub(crate) WorstBy);

impl Badness {
    /// Returns the candidates for the badness of a triangle, and their number: 1 for the mean ratio, 3 for angle and
    /// altitude (one for each angle or edge). The badness is the maximum of the candidates, and p-norms sum powers of
    /// each.
    fn terms<T: Real>(self, corner: &Corner<T>) -> ([T; 3], usize) {
        let [a, b, c] = corner.squared_lengths();
        let area = corner.doubled_area();
        let per_area = area.constant(1.0) / (area * area);
        match self.0 {
            // A quadrilateral has the angle between the two sides, and none at its diagonals.
            WorstBy::MinAngle if corner.ideal.is_right => {
                let Corner { a, b, .. } = corner.before_shear();
                let area = a[0] * b[1] - a[1] * b[0];
                let cotangent = (a[0] * b[0] + a[1] * b[1]) / area;
                // An obtuse angle is as good as a right one, though its sine is small.
                let cotangent = cotangent.max(area.constant(0.0));
                ([cotangent * cotangent + 1.0; 3], 1)
            }
            WorstBy::Imr => {
                let sum = (a + b + c) * IDEAL;
                ([sum * sum * per_area; 3], 1)
            }
            // The sine of an angle is twice the area, divided by the lengths of its two edges.
            WorstBy::MinAngle => ([a * b * per_area, a * c * per_area, b * c * per_area], 3),
            WorstBy::Altitude => ([a * per_area, b * per_area, c * per_area], 3),
        }
    }

    /// Returns whether the measure applies to triangles transformed by their target maps.
    pub(crate) fn is_of_targets(self) -> bool {
        self.0 != WorstBy::Altitude
    }

    /// Returns a triangle with one corner at `at`, transformed by its target map if the measure applies to targets, and
    /// in the coordinates of the mesh otherwise.
    pub(crate) fn seen(
        self,
        triangle: &FanCorner,
        at: DVec2,
        ideal: Ideal,
        coordinates: MeshCoordinates,
    ) -> Corner<f64> {
        if !self.is_of_targets() {
            let ends = triangle.ends.map(|end| coordinates.at(end));
            return FanCorner { ends, ..*triangle }.edges(coordinates.at(at), ideal);
        }
        let corner = triangle.in_plane(at, ideal);
        triangle.map.map_or(corner, |map| map.transform(&corner))
    }

    /// Returns the badness of a triangle given by [`seen`](Self::seen); infinite for an inverted or flat triangle.
    pub(crate) fn of(self, corner: &Corner<f64>) -> f64 {
        if !is_sound(corner) {
            return f64::INFINITY;
        }
        let (terms, _) = self.terms(corner);
        terms.into_iter().fold(0.0, f64::max)
    }

    /// Returns the badness of the worst triangle of a patch, with the visited vertex at `at`.
    pub(crate) fn worst_of(self, patch: &FanPatch, at: DVec2) -> f64 {
        let of = |triangle: &FanCorner| {
            self.of(&self.seen(triangle, at, patch.ideal, patch.coordinates))
        };
        patch.corners.iter().map(of).fold(0.0, f64::max)
    }

    /// Returns Σ (candidate / `unit`)^k, with k = 2^`doublings`, over the candidates of a triangle given by
    /// [`seen`](Self::seen).
    pub(crate) fn power(self, corner: &Corner<f64>, unit: f64, doublings: u32) -> f64 {
        let (terms, count) = self.terms(corner);
        terms[..count].iter().map(|term| power(term / unit, doublings)).sum()
    }

    /// Returns the slopes of the edges of a corner as [`seen`](Self::seen) returns it, by the position of the visited vertex.
    pub(crate) fn slopes(self, corner: &FanCorner) -> Given {
        match self.is_of_targets() {
            true => corner.role.slopes(),
            false => corner.role.plane_slopes(),
        }
    }

    /// Returns the sum of [`power`](Self::power) with its derivatives by the visited vertex. `edges` has the slopes of the
    /// edges by the position of the vertex.
    pub(crate) fn power_derivatives(
        self,
        corner: &Corner<f64>,
        edges: Given,
        unit: f64,
        doublings: u32,
    ) -> Dual<f64> {
        let vertex =
            |edge: [f64; 2], slope| [0, 1].map(|axis| Dual::variable(edge[axis], axis, slope));
        let (a, b) = (vertex(corner.a, edges.alpha()), vertex(corner.b, edges.beta()));
        let (terms, count) = self.terms(&Corner { a, b, ideal: corner.ideal });
        let k = 2f64.powi(doublings as i32);
        terms[..count].iter().fold(Dual::default(), |sum, term| {
            let value = power(term.value / unit, doublings);
            let (slope, bend) = (k * value / term.value, (k - 1.0) / term.value);
            let ([x, y], [xx, xy, yy]) = (term.gradient, term.hessian);
            let hessian = [xx + bend * x * x, xy + bend * x * y, yy + bend * y * y];
            let gradient = [slope * x, slope * y];
            sum + Dual { value, gradient, hessian: hessian.map(|second| slope * second) }
        })
    }

    /// Converts a badness to the measure: an inverse mean ratio, an angle in degrees, or an altitude in the unit of the
    /// mesh.
    pub(crate) fn meaning(self, badness: f64, problem: &Problem) -> f64 {
        match self.0 {
            WorstBy::Imr => badness.sqrt(),
            WorstBy::MinAngle => badness.sqrt().recip().min(1.0).asin().to_degrees(),
            WorstBy::Altitude => (badness.sqrt() * problem.normalization().1).recip(),
        }
    }
}

/// Returns x^k with k = 2^`doublings`.
fn power(x: f64, doublings: u32) -> f64 {
    (0..doublings).fold(x, |x, _| x * x)
}

/// Returns whether a triangle is neither inverted nor flat, both exactly and in double precision.
fn is_sound(corner: &Corner<f64>) -> bool {
    is_positive(&[[0.0; 2], corner.a, corner.b], &[0, 1, 2]) && corner.doubled_area() > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::Role;

    const POINTS: [[f64; 2]; 3] = [[0.1, 0.2], [1.3, 0.1], [0.4, 0.9]];

    fn seen_from(at: [f64; 2]) -> Corner<f64> {
        let ends = [POINTS[1], POINTS[2]].map(DVec2::from);
        FanCorner { ends, map: None, role: Role::Triangle }.in_plane(at.into(), Ideal::of_area(1.0))
    }

    #[test]
    fn measures_are_those_of_the_triangle() {
        let [p, q, r] = POINTS.map(DVec2::from);
        let (a, b, c) = (p.distance(q), p.distance(r), q.distance(r));
        let area = (q - p).perp_dot(r - p);
        // Heron's formula and the law of cosines, which the tested code does not use.
        let half = 0.5 * (a + b + c);
        let heron = 2.0 * (half * (half - a) * (half - b) * (half - c)).sqrt();
        assert!((heron - area).abs() < 1e-15);
        let angle = |opposite: f64, x: f64, y: f64| {
            ((x * x + y * y - opposite * opposite) / (2.0 * x * y)).acos().to_degrees()
        };
        let least = angle(a, b, c).min(angle(b, a, c)).min(angle(c, a, b));
        let corner = seen_from(POINTS[0]);
        let imr = Badness(WorstBy::Imr).of(&corner).sqrt();
        assert!((imr - (a * a + b * b + c * c) / (12f64.sqrt() * heron)).abs() < 1e-14);
        let sine = Badness(WorstBy::MinAngle).of(&corner).sqrt().recip();
        assert!((sine.asin().to_degrees() - least).abs() < 1e-12);
        let altitude = Badness(WorstBy::Altitude).of(&corner).sqrt().recip();
        assert!((altitude - heron / a.max(b).max(c)).abs() < 1e-15);
        let inverted = Corner { a: corner.b, b: corner.a, ..corner };
        assert!(WorstBy::ALL.iter().all(|&by| Badness(by).of(&inverted) == f64::INFINITY));
    }

    /// The sine of an obtuse angle counted as that of a small one.
    #[test]
    fn an_obtuse_corner_of_a_quadrilateral_is_as_good_as_a_right_one() {
        let ideal = Ideal { is_right: true, ..Ideal::of_area(1.0) };
        let of = |angle: f64| {
            let (sine, cosine) = angle.to_radians().sin_cos();
            let corner = Corner { a: [1.0, 0.0], b: [2.0 * cosine, 2.0 * sine], ideal };
            Badness(WorstBy::MinAngle).of(&corner.of_right_angle())
        };
        for angle in [90.0, 120.0, 175.0] {
            assert!((of(angle) - 1.0).abs() < 1e-12, "{angle}: {}", of(angle));
        }
        assert!((of(30.0) - 4.0).abs() < 1e-12);
    }

    #[test]
    fn derivatives_are_those_of_the_power() {
        let h = 1e-5;
        for by in WorstBy::ALL {
            let (badness, unit) = (Badness(by), 3.0);
            for doublings in [0, 3] {
                let value = |x: f64, y: f64| {
                    let [px, py] = POINTS[0];
                    badness.power(&seen_from([px + x * h, py + y * h]), unit, doublings)
                };
                let found = badness.power_derivatives(
                    &seen_from(POINTS[0]),
                    Given(-1.0, -1.0),
                    unit,
                    doublings,
                );
                let here = value(0.0, 0.0);
                assert!((found.value - here).abs() < 1e-12 * here);
                let size = found.hessian.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
                let (left, right) = (value(-1.0, 0.0), value(1.0, 0.0));
                let (low, high) = (value(0.0, -1.0), value(0.0, 1.0));
                let gradient = [(right - left) / (2.0 * h), (high - low) / (2.0 * h)];
                let cross =
                    value(1.0, 1.0) - value(1.0, -1.0) - value(-1.0, 1.0) + value(-1.0, -1.0);
                let hessian = [right - 2.0 * here + left, 0.25 * cross, high - 2.0 * here + low];
                for (got, want) in found.gradient.into_iter().zip(gradient) {
                    assert!((got - want).abs() < 1e-7 * size, "{by:?}: {got} {want}");
                }
                for (got, want) in found.hessian.into_iter().zip(hessian) {
                    assert!((got - want / (h * h)).abs() < 1e-4 * size, "{by:?}: {got} {want}");
                }
            }
        }
    }
}
