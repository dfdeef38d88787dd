//! A patch as a list of weighted corner triangles, and its objective by a metric.

use std::ops::Mul;

use crate::metric::{Corner, Dual, EdgeSlopes, Formulas, Given, Real, Smoothing, opposite_angles};
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

    /// Returns the number of quadrilaterals.
    #[inline(always)]
    fn quadrilaterals(&self) -> usize {
        0
    }

    /// Returns a quadrilateral: the index of its first corner, and its corner opposite the visited vertex, transformed by its
    /// target map. The first corner is at the visited vertex. The corners of both neighbors of the vertex follow.
    #[inline(always)]
    fn quadrilateral(&self, _: usize) -> (usize, Corner<T>) {
        unreachable!("a patch of triangles has no quadrilaterals")
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

impl<P, F: Formulas> MetricObjective<'_, P, F> {
    /// Adds the terms of opposite angles of the quadrilaterals of the patch to the sum over its corners, with the visited
    /// vertex at `at`.
    #[inline(always)]
    pub(crate) fn with_opposite_angles<T: Numbers>(&self, mut sum: Dual<T>, at: [T; 2]) -> Dual<T>
    where
        P: Corners<T>,
    {
        for k in 0..self.joined::<T>() {
            let (first, opposite) = self.patch.quadrilateral(k);
            let cotangent = |i: usize| {
                let (corner, slopes) = (self.patch.corner(i, at), self.patch.slopes(i));
                self.patch.pull_back(i, opposite_angles::cotangent_expansion(&corner, slopes))
            };
            let opposite = opposite_angles::cotangent_expansion(&opposite, Given(0.0, 0.0));
            let [own, next, last] = [cotangent(first), cotangent(first + 1), cotangent(first + 2)];
            sum = sum + opposite_angles::of_cotangents([own, next, opposite, last]);
        }
        sum
    }

    /// Returns the sum of the terms of opposite angles of the quadrilaterals of the patch, with the visited vertex at `at`.
    #[inline(always)]
    pub(crate) fn opposite_angles<T: Numbers>(&self, at: [T; 2]) -> T
    where
        P: Corners<T>,
    {
        let mut sum = at[0].constant(0.0);
        for k in 0..self.joined::<T>() {
            let (first, opposite) = self.patch.quadrilateral(k);
            let cotangent = |i| opposite_angles::cotangent(&self.patch.corner(i, at));
            let [own, next, last] = [cotangent(first), cotangent(first + 1), cotangent(first + 2)];
            let opposite = opposite_angles::cotangent(&opposite);
            sum = sum + opposite_angles::of_cotangents([own, next, opposite, last]);
        }
        sum
    }

    /// Returns the number of quadrilaterals with a term of opposite angles.
    #[inline(always)]
    fn joined<T: Numbers>(&self) -> usize
    where
        P: Corners<T>,
    {
        if self.formulas.metric().joins_opposite_angles() { self.patch.quadrilaterals() } else { 0 }
    }
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
        self.with_opposite_angles(sum, at)
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
        (sum + self.opposite_angles(to), feasible)
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
