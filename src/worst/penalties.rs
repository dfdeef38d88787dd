//! The penalties that bring triangles back within limits of angle and inverse mean ratio.

use crate::metric::{
    Corner, Dual, EdgeSlopes, Formulas, Given, Hinge, Metric, OfEdges, Real, Smoothing,
};
use crate::patch::{FanCorner, FanPatch, MetricObjective, Objective, Role, is_acceptable};
use crate::slide::OfPatch;
use crate::worst::shapes::WorstShapes;

/// Factor of the least angle, and share of the worst squared inverse mean ratio's excess over 1, that give the limits of
/// the penalties. The limits are a little stricter than the shapes that must not become worse, as a penalty is still zero at
/// its limit.
const ANGLE_RESERVE: f64 = 1.01;
const SQUARE_RESERVE: f64 = 0.98;
/// Width of the cubic part of the penalties, as a share of their limits.
const RAMP: f64 = 0.05;
/// Weight of the penalties in the first two rounds. The weight is tripled in every second round, so that most meshes end
/// near the least f.
const FIRST_WEIGHT: f64 = 1000.0;
/// Number of rounds after which the weight becomes tenfold in each round, up to the largest weight. Only triangles that
/// can be no better than the limit need such weights.
const SLOW_ROUNDS: u32 = 8;
const LAST_WEIGHT: f64 = 1e12;
/// Width of the cubic part of the penalty on small angles beside the penalty on large angles.
const SMALL_RAMP: f64 = 0.2;
/// Factor of the penalties on heavy triangles.
const HEAVY: f64 = 4.0;
/// Weight of penalties on small angles beside those on large angles.
const SMALL_SHARE: f64 = 0.3;

/// The function of a triangle that vertices lower in rounds of Newton steps: imr² + weight (Σ ψ(cot) + Σ ψ(-cot) + ψ(imr²)),
/// with penalties ψ on small angles and on large angles by their cotangents, and on imr², the squared inverse mean ratio.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Penalties {
    small: Hinge,
    large: Hinge,
    square: Hinge,
    weight: f64,
    /// Factor of the penalty on small angles.
    small_share: f64,
    /// Whether quadrilaterals have the function of ACUTE instead.
    has_acute_quadrilaterals: bool,
}

impl Penalties {
    /// Returns the penalties of the floor in the first round, for triangles that must not be worse than `worst`.
    pub(crate) fn new(worst: WorstShapes) -> Self {
        let angle = ANGLE_RESERVE * worst.least_angle().to_radians();
        let hinge = |limit: f64| Hinge { limit, ramp: RAMP * limit };
        Self {
            small: hinge(angle.tan().recip()),
            large: Hinge::NONE,
            square: hinge(1.0 + SQUARE_RESERVE * (worst.imr * worst.imr - 1.0)),
            weight: FIRST_WEIGHT,
            small_share: 1.0,
            has_acute_quadrilaterals: false,
        }
    }

    /// Returns penalties on angles of triangles above 78.7 degrees, as in ACUTE, and on those whose cotangent is above `small`.
    /// Quadrilaterals have the function of ACUTE, so that they remain orthogonal to their neighbors.
    pub(crate) fn on_large_angles(small: f64, weight: f64) -> Self {
        Self {
            small: Hinge { limit: small, ramp: SMALL_RAMP },
            large: Hinge::LARGE_ANGLES,
            square: Hinge::NONE,
            weight,
            small_share: SMALL_SHARE,
            has_acute_quadrilaterals: true,
        }
    }

    /// Returns the limits of the penalties.
    pub(crate) fn limits(&self) -> WorstShapes {
        WorstShapes { cotangent: self.small.limit, imr: self.square.limit.sqrt() }
    }

    /// Returns the penalties of a round, counted from 0.
    pub(crate) fn in_round(self, round: u32) -> Self {
        let (slow, fast) = (round.min(SLOW_ROUNDS) / 2, round.saturating_sub(SLOW_ROUNDS));
        let weight = FIRST_WEIGHT * 3f64.powi(slow as i32) * 10f64.powi(fast as i32);
        Self { weight: weight.min(LAST_WEIGHT), ..self }
    }

    fn square<T: Real>([a, b, c]: [T; 3]) -> T {
        (a * a + b * b + c * c + 2.0) * (1.0 / 3.0)
    }

    /// Returns the cotangents of the angles: three of a triangle, and one of a corner of a quadrilateral.
    fn angles<T: Real>(corner: &Corner<T>, cotangents: [T; 3]) -> impl Iterator<Item = T> {
        let (list, count) = match corner.ideal.is_right {
            true => ([corner.before_shear().cotangents()[0]; 3], 1),
            false => (cotangents, 3),
        };
        list.into_iter().take(count)
    }

    /// Returns whether the function of a corner is that of ACUTE.
    fn is_acute<T>(&self, corner: &Corner<T>) -> bool {
        self.has_acute_quadrilaterals && corner.ideal.is_right
    }

    fn of(&self, corner: &Corner<f64>) -> f64 {
        if self.is_acute(corner) {
            return Metric::Acute.excess(corner) + 1.0;
        }
        let cotangents = corner.cotangents();
        let square = Self::square(cotangents);
        let angles = || Self::angles(corner, cotangents);
        let small: f64 = angles().map(|x| self.small.of(x)).sum();
        let large: f64 = angles().map(|x| self.large.of(-x)).sum();
        square + self.weight * (small * self.small_share + large + self.square.of(square))
    }

    /// Returns the function with its derivatives by the visited vertex. `edges` has the slopes of the edges by the position of
    /// the vertex.
    fn expansion(&self, corner: &Corner<f64>, edges: Given) -> Dual {
        if self.is_acute(corner) {
            return Metric::Acute.formulas().expansion(corner, edges, Smoothing::of(0)) + 1.0;
        }
        let vertex =
            |edge: [f64; 2], slope| [0, 1].map(|axis| Dual::variable(edge[axis], axis, slope));
        let (a, b) = (vertex(corner.a, edges.alpha()), vertex(corner.b, edges.beta()));
        let corner = Corner { a, b, ideal: corner.ideal };
        let cotangents = corner.cotangents();
        let square = Self::square(cotangents);
        let angles = Self::angles(&corner, cotangents);
        let penalties = angles.fold(self.square.expansion(square), |sum, x| {
            let small = self.small.expansion(x) * self.small_share;
            sum + small + self.large.expansion(x * -1.0)
        });
        square + penalties * self.weight
    }
}

/// The sum of [`Penalties`] over a patch.
pub(crate) struct PenaltyObjective<'a> {
    pub(crate) patch: &'a FanPatch,
    pub(crate) penalties: Penalties,
    /// Whether the penalties on each triangle of the patch are multiplied by [`HEAVY`]. Empty if none are.
    pub(crate) heavy: Vec<bool>,
}

impl PenaltyObjective<'_> {
    /// Returns the corners of the patch with their penalties and places of the visited vertex.
    fn corners(&self, at: [f64; 2]) -> impl Iterator<Item = (Corner<f64>, Penalties, Role)> {
        let Self { patch, penalties, ref heavy } = *self;
        let of = move |(k, triangle): (usize, &FanCorner)| {
            let is_heavy = heavy.get(k).copied().unwrap_or_default();
            let weight = if is_heavy { HEAVY * penalties.weight } else { penalties.weight };
            let corner = triangle.in_plane(at.into(), patch.ideal);
            (corner, Penalties { weight, ..penalties }, triangle.role)
        };
        patch.corners.iter().enumerate().map(of)
    }

    /// Returns the objective whose terms of opposite angles belong to the sum; `None` if there are none.
    fn joined(&self) -> Option<MetricObjective<'_, FanPatch, impl Formulas>> {
        self.penalties.has_acute_quadrilaterals.then(|| {
            let (formulas, smoothing) = (Metric::Acute.formulas(), Smoothing::of(0));
            MetricObjective { patch: self.patch, formulas, smoothing, shape_guard: f64::INFINITY }
        })
    }
}

impl Objective<f64> for PenaltyObjective<'_> {
    fn expansion(&self, at: [f64; 2]) -> Dual {
        let add = |sum, (corner, penalties, role): (_, Penalties, Role)| {
            sum + role.weighted(penalties.expansion(&corner, role.slopes()))
        };
        let sum = self.corners(at).fold(Dual::default(), add);
        self.joined().map_or(sum, |joined| joined.with_opposite_angles(sum, at))
    }

    fn trial(&self, to: [f64; 2], _: f64) -> (f64, bool) {
        let of =
            |(corner, penalties, role): (_, Penalties, Role)| role.weighted(penalties.of(&corner));
        let joined = self.joined().map_or(0.0, |joined| joined.opposite_angles(to));
        (self.corners(to).map(of).sum::<f64>() + joined, true)
    }
}

/// The penalties for vertices that slide, whose trials keep triangles positive.
impl OfPatch for Penalties {
    fn of<'p>(&'p self, patch: &'p FanPatch) -> Box<dyn Objective<f64> + 'p> {
        Box::new(Feasible(PenaltyObjective { patch, penalties: *self, heavy: Vec::new() }))
    }
}

/// An objective whose trials are accepted only if no triangle is inverted, flat or below the least altitude of the patch.
struct Feasible<'a>(PenaltyObjective<'a>);

impl Objective<f64> for Feasible<'_> {
    fn expansion(&self, at: [f64; 2]) -> Dual {
        self.0.expansion(at)
    }

    fn trial(&self, to: [f64; 2], max_imr: f64) -> (f64, bool) {
        match is_acceptable(self.0.patch, OfEdges, to, f64::INFINITY) {
            true => self.0.trial(to, max_imr),
            false => (f64::INFINITY, false),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::metric::Ideal;

    #[test]
    fn derivatives_are_those_of_the_penalties() {
        let worst = WorstShapes { cotangent: 1.2, imr: 1.1 };
        let weight = |round: u32| Penalties::new(worst).in_round(round).weight;
        assert_eq!([0, 1, 2, 8, 9, 99].map(weight), [1e3, 1e3, 3e3, 8.1e4, 8.1e5, 1e12]);
        let penalties = Penalties::new(worst).in_round(3);
        let ends = [[1.3, 0.1], [0.4, 0.9]].map(DVec2::from);
        let role = Role::Triangle;
        let corner = |x: f64, y: f64| {
            FanCorner { ends, map: None, role }.in_plane(DVec2::new(x, y), Ideal::of_area(1.0))
        };
        // Both penalties act at the first place, and neither at the second.
        let (h, mut sizes) = (1e-5, Vec::new());
        for [x, y] in [[0.1, 0.4], [0.15, 0.0]] {
            let value = |i: f64, j: f64| penalties.of(&corner(x + i * h, y + j * h));
            let found = penalties.expansion(&corner(x, y), role.slopes());
            let here = value(0.0, 0.0);
            assert!((found.value - here).abs() < 1e-12 * here);
            let size = found.hessian.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
            let (left, right) = (value(-1.0, 0.0), value(1.0, 0.0));
            let (low, high) = (value(0.0, -1.0), value(0.0, 1.0));
            let gradient = [(right - left) / (2.0 * h), (high - low) / (2.0 * h)];
            let cross = value(1.0, 1.0) - value(1.0, -1.0) - value(-1.0, 1.0) + value(-1.0, -1.0);
            let hessian = [right - 2.0 * here + left, 0.25 * cross, high - 2.0 * here + low];
            for (got, want) in found.gradient.into_iter().zip(gradient) {
                assert!((got - want).abs() < 1e-6 * size, "{got} {want}");
            }
            for (got, want) in found.hessian.into_iter().zip(hessian) {
                assert!((got - want / (h * h)).abs() < 1e-3 * size, "{got} {want}");
            }
            sizes.push(here);
        }
        assert!(sizes[0] > 100.0 && sizes[1] < 2.0, "{sizes:?}");
    }

    #[test]
    fn limits_are_a_little_better_than_the_worst_shapes() {
        let worst = WorstShapes { cotangent: 1.0, imr: 1.25 };
        let limits = Penalties::new(worst).limits();
        assert!((limits.least_angle() - 45.45).abs() < 1e-9);
        assert!((limits.imr.powi(2) - (1.0 + 0.98 * 0.5625)).abs() < 1e-12);
        let none = Penalties::new(WorstShapes { cotangent: f64::INFINITY, imr: f64::INFINITY });
        assert_eq!(none.limits().imr, f64::INFINITY);
        assert!(
            none.of(&Corner { a: [1.0, 0.0], b: [0.0, 1e-3], ideal: Ideal::of_area(1.0) }) > 0.0
        );
    }
}
