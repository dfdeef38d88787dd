//! The Newton step of a vertex with its line search. All visits on the host call this function.

use crate::metric::{Dual, Real};
use crate::patch::direction::{Direction, newton_direction};
use crate::patch::numbers::{Mask, Numbers};
use crate::patch::search_rule::{FLAT_EXPONENT, FLAT_RATIO, MIN_FLAT_SUM, MIN_MOVE, SearchRule};

/// A function of the position of one vertex, or of one vertex in each lane, that a Newton step lowers.
pub(crate) trait Objective<T: Numbers> {
    /// Returns value, gradient and Hessian of the objective.
    fn expansion(&self, at: [T; 2]) -> Dual<T>;

    /// Returns the value at a trial position, and whether the trial is feasible. If the objective has a
    /// [`shape guard`](Self::shape_guard), inverse mean ratios above `max_imr` are infeasible.
    fn trial(&self, to: [T; 2], max_imr: T) -> (T, T::Mask);

    /// Returns the direction of the search.
    #[inline(always)]
    fn direction(&self, here: &Dual<T>, eigenvalue_floor: f64) -> Direction<T> {
        newton_direction(here, eigenvalue_floor)
    }

    /// Returns the point of a trial, given the point on the straight line of the search.
    #[inline(always)]
    fn point(&self, on_line: [T; 2]) -> [T; 2] {
        on_line
    }

    /// Returns the change of the value that the gradient predicts for a trial at `to`. A trial is accepted only if the
    /// prediction is negative. `None` for trials on the straight line, where the slope predicts the change.
    #[inline(always)]
    fn predicted(&self, _here: &Dual<T>, _to: [T; 2]) -> Option<T> {
        None
    }

    /// Returns the sum of q² over the patch, given the value, which is the sum of q² - ideal².
    #[inline(always)]
    fn squares(&self, value: T) -> T {
        value
    }

    /// Returns the largest inverse mean ratio that a step may leave, unless the patch already has a larger one;
    /// infinite for no guard.
    #[inline(always)]
    fn shape_guard(&self) -> f64 {
        f64::INFINITY
    }

    /// Returns the largest inverse mean ratio of the patch. Called if there is a shape guard.
    fn worst_shape(&self, at: [T; 2]) -> T {
        at[0].constant(f64::INFINITY)
    }
}

/// Takes one Newton step with its line search, for the vertices in `going`. Returns the new positions, and which
/// vertices took a step.
#[inline(always)]
pub(crate) fn newton_step<T: Numbers>(
    objective: &(impl Objective<T> + ?Sized),
    at: [T; 2],
    going: T::Mask,
    rule: &SearchRule,
) -> ([T; 2], T::Mask) {
    let here = objective.expansion(at);
    let direction = objective.direction(&here, rule.eigenvalue_floor);
    let Direction { vector: [dx, dy], slope, descends } = direction;
    let squares = objective.squares(here.value);
    let most = match rule.slack > 0.0 {
        true => here.value + squares * rule.slack,
        false => here.value,
    };
    let wanted = slope * rule.sufficient_decrease.unwrap_or(0.0);

    let mut length = at[0].constant(rule.first_length);
    if let Some(max_lengthening) = rule.max_lengthening {
        length = lengthened(length, at, &direction, squares, max_lengthening);
    }
    let mut searching = going & descends;
    let (mut end, mut stepped) = (at, at[0].mask(false));
    // A triangle may stay as bad as the worst of the patch. Few trials break the guard, so the worst ratio is computed
    // only after a trial does.
    let guard = objective.shape_guard();
    let mut max_imr = at[0].constant(guard);
    let mut worst_is_known = !guard.is_finite();
    let mut trial = 0;
    while trial < rule.trials && !searching.none() {
        let to = objective.point([at[0] + dx * length, at[1] + dy * length]);
        let (value, feasible) = objective.trial(to, max_imr);
        if !worst_is_known && !(!searching | feasible).all() {
            worst_is_known = true;
            max_imr = Real::max(max_imr, objective.worst_shape(at));
            continue;
        }
        trial += 1;
        let mut accepted = searching & feasible;
        if rule.sufficient_decrease.is_some() {
            let least = match objective.predicted(&here, to) {
                None => wanted * length,
                Some(predicted) => {
                    accepted = accepted & predicted.lt(predicted.constant(0.0));
                    predicted * rule.sufficient_decrease.unwrap_or(0.0)
                }
            };
            accepted = accepted & value.le(most + least);
        }
        end = [T::select(accepted, to[0], end[0]), T::select(accepted, to[1], end[1])];
        stepped = stepped | accepted;
        searching = searching & !accepted;
        let shorter = length * rule.shorten;
        length = T::select(feasible, shorter, length * rule.shorten_infeasible);
    }
    (end, stepped)
}

/// Takes one Newton step of a single vertex by [`newton_step`]. Returns the new position, and whether the vertex took a
/// step. The search is compiled once for all objectives of `f64`.
#[inline(never)]
pub(crate) fn step_alone(
    objective: &dyn Objective<f64>,
    at: [f64; 2],
    rule: &SearchRule,
) -> ([f64; 2], bool) {
    newton_step(objective, at, true, rule)
}

/// Returns the first length of a search, longer where nearly flat triangles make up most of the objective; see
/// [`FLAT_EXPONENT`].
#[inline(always)]
fn lengthened<T: Numbers>(
    length: T,
    at: [T; 2],
    direction: &Direction<T>,
    squares: T,
    max_lengthening: f64,
) -> T {
    let Direction { vector: [dx, dy], slope, .. } = *direction;
    let share = slope.negative() / squares;
    let flat = share.constant(FLAT_RATIO).lt(share) & squares.constant(MIN_FLAT_SUM).lt(squares);
    if flat.none() {
        return length;
    }
    let rest = Real::max(
        share.constant(1.0) - share * FLAT_EXPONENT,
        share.constant(1.0 / max_lengthening),
    );
    // A triangle may be as flat as positions are coarse. A step shorter than `coarse` would be rounded away.
    let coarse = Real::max(at[0].abs(), at[1].abs()) * MIN_MOVE;
    let far = Real::max(length / rest, coarse / Real::sqrt(dx * dx + dy * dy));
    T::select(flat, far, length)
}
