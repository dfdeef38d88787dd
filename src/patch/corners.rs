//! A patch as a list of weighted corner triangles, and its objective by a metric.

use std::ops::Mul;

use crate::metric::{Corner, Dual, EdgeSlopes, Formulas, Real, Smoothing};
use crate::patch::acceptance::{is_positive, is_within};
use crate::patch::direction::{Direction, newton_direction};
use crate::patch::newton_step::Objective;
use crate::patch::numbers::Numbers;

/// The corner triangles of a patch: those whose edges depend on the visited vertex, or on one vertex in each lane. A
/// mesh triangle contributes one corner to the patch of each vertex, a quadrilateral contributes three.
pub(crate) trait Corners<T: Numbers> {
    /// The type of the slopes of edges by the position of the visited vertex.
    type Slopes: EdgeSlopes;

    /// Number of corners.
    fn count(&self) -> usize;

    /// Returns a corner, transformed by its target map if there is one, with the visited vertex at `at`.
    fn corner(&self, i: usize, at: [T; 2]) -> Corner<T>;

    /// Returns the slopes of the edges of a corner.
    fn slopes(&self, i: usize) -> Self::Slopes;

    /// Returns a term of a corner times the weight of the corner: 1 for a triangle, 1/4 for a corner of a
    /// quadrilateral. A factor of 1 is left out of the code, which is compiled for each metric.
    #[inline(always)]
    fn weighted<V: Mul<f64, Output = V>>(&self, _: usize, term: V) -> V {
        term
    }

    /// Returns the sum of the weights.
    #[inline(always)]
    fn total_weight(&self) -> f64 {
        self.count() as f64
    }

    /// Converts derivatives by the visited vertex in the coordinates of a corner's target map to those of the plane.
    #[inline(always)]
    fn pull_back(&self, _: usize, transformed: Dual<T>) -> Dual<T> {
        transformed
    }

    /// Returns the Newton direction for the derivatives of the sum over the patch.
    #[inline(always)]
    fn direction(&self, sum: &Dual<T>, eigenvalue_floor: f64) -> Direction<T> {
        newton_direction(sum, eigenvalue_floor)
    }

    /// Returns whether the triangle of corner `i` is neither inverted nor flat. `corner` is the result of
    /// [`corner`](Self::corner) for `i` and `at`.
    #[inline(always)]
    fn is_positive(&self, _: usize, _at: [T; 2], corner: &Corner<T>) -> T::Mask {
        is_positive(corner)
    }
}

/// Returns whether every corner of a patch is positive and has an inverse mean ratio of at most `max_imr`, with the
/// vertex at `at`.
#[inline(always)]
pub(crate) fn is_acceptable<T: Numbers>(
    patch: &impl Corners<T>,
    formulas: impl Formulas,
    at: [T; 2],
    max_imr: T,
) -> T::Mask {
    let mut acceptable = at[0].mask(true);
    for i in 0..patch.count() {
        let corner = patch.corner(i, at);
        let is_positive = patch.is_positive(i, at, &corner);
        acceptable = acceptable & is_positive & is_within(formulas, &corner, max_imr);
    }
    acceptable
}

/// The sum over a patch of the function that Newton's method minimizes for a metric.
#[derive(Clone, Copy)]
pub(crate) struct MetricObjective<'a, P, F> {
    pub(crate) patch: &'a P,
    pub(crate) formulas: F,
    pub(crate) smoothing: Smoothing,
    /// Largest inverse mean ratio that a step may leave, unless the patch already has a larger one; infinite for no
    /// guard.
    pub(crate) shape_guard: f64,
}

impl<T: Numbers, P: Corners<T>, F: Formulas> Objective<T> for MetricObjective<'_, P, F> {
    #[inline(always)]
    fn expansion(&self, at: [T; 2]) -> Dual<T> {
        let zero = at[0].constant(0.0);
        let mut sum = Dual { value: zero, gradient: [zero; 2], hessian: [zero; 3] };
        for i in 0..self.patch.count() {
            let corner = self.patch.corner(i, at);
            let transformed =
                self.formulas.expansion(&corner, self.patch.slopes(i), self.smoothing);
            sum = sum + self.patch.weighted(i, self.patch.pull_back(i, transformed));
        }
        sum
    }

    #[inline(always)]
    fn trial(&self, to: [T; 2], max_imr: T) -> (T, T::Mask) {
        let mut sum = to[0].constant(0.0);
        let mut feasible = sum.mask(true);
        let is_guarded = self.shape_guard.is_finite();
        for i in 0..self.patch.count() {
            let corner = self.patch.corner(i, to);
            feasible = feasible & self.patch.is_positive(i, to, &corner);
            if is_guarded {
                feasible = feasible & is_within(self.formulas, &corner, max_imr);
            }
            sum = sum + self.patch.weighted(i, self.formulas.model(&corner, self.smoothing));
        }
        (sum, feasible)
    }

    #[inline(always)]
    fn direction(&self, here: &Dual<T>, eigenvalue_floor: f64) -> Direction<T> {
        self.patch.direction(here, eigenvalue_floor)
    }

    #[inline(always)]
    fn squares(&self, value: T) -> T {
        value + self.patch.total_weight() * self.formulas.metric().ideal_squared()
    }

    #[inline(always)]
    fn shape_guard(&self) -> f64 {
        self.shape_guard
    }

    /// Returns the largest inverse mean ratio of the patch, infinite if a triangle is inverted or flat.
    #[inline(always)]
    fn worst_shape(&self, at: [T; 2]) -> T {
        let mut worst = at[0].constant(0.0);
        for i in 0..self.patch.count() {
            let corner = self.patch.corner(i, at);
            let (numerator, area) = self.formulas.inverse_mean_ratio(&corner);
            let ratio = numerator / area;
            let infinite = worst.constant(f64::INFINITY);
            worst = Real::max(worst, T::select(is_positive(&corner), ratio, infinite));
        }
        worst
    }
}
