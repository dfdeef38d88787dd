//! Acceptance tests of a triangle and of a position after a move.

use glam::DVec2;

use crate::metric::{Corner, Formulas};
use crate::patch::numbers::{Mask, Numbers};

/// Whether a triangle is neither inverted nor flat, by its rounded area.
#[inline(always)]
pub(crate) fn is_positive<T: Numbers>(corner: &Corner<T>) -> T::Mask {
    let area = corner.doubled_area();
    area.constant(0.0).lt(area)
}

/// Whether the inverse mean ratio of a triangle with positive area is at most `max_imr`.
#[inline(always)]
pub(crate) fn is_within<T: Numbers>(
    formulas: impl Formulas,
    corner: &Corner<T>,
    max_imr: T,
) -> T::Mask {
    // Both sides are multiplied by the area, as a division costs as much as the rest of the guard.
    let (numerator, area) = formulas.inverse_mean_ratio(corner);
    numerator.le(max_imr * area)
}

/// Whether a moved triangle has positive area, and an inverse mean ratio of at most `guard` or of at most the ratio
/// `before` the move.
#[inline(always)]
pub(crate) fn is_kept<T: Numbers>(
    formulas: impl Formulas,
    before: &Corner<T>,
    now: &Corner<T>,
    guard: f64,
) -> T::Mask {
    let positive = is_positive(now);
    if !guard.is_finite() {
        return positive;
    }
    let within = is_within(formulas, now, now.a[0].constant(guard));
    // Few moves break the guard, so the triangle before the move is evaluated only then.
    if within.all() {
        return positive;
    }
    let (numerator, area) = formulas.inverse_mean_ratio(now);
    let (numerator_before, area_before) = formulas.inverse_mean_ratio(before);
    positive & (within | (numerator * area_before).le(numerator_before * area))
}

/// A circle that limits the moves of a vertex; an infinite radius stands for no limit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Circle {
    pub(crate) center: DVec2,
    pub(crate) radius: f64,
}

impl Circle {
    /// Whether a point is in the circle.
    pub(crate) fn contains(self, at: DVec2) -> bool {
        !self.radius.is_finite() || at.distance(self.center) <= self.radius
    }

    /// Returns a point, brought back to the circle if the point is beyond.
    pub(crate) fn nearest(self, to: DVec2) -> DVec2 {
        let distance = to.distance(self.center);
        if distance <= self.radius {
            to
        } else {
            self.center + (to - self.center) * (self.radius / distance)
        }
    }
}
