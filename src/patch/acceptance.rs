//! Acceptance tests of a triangle and of a position after a move.

use glam::DVec2;

use crate::layout::MeshCoordinates;
use crate::measure::altitude;
use crate::metric::{Corner, Formulas, OfEdges};
use crate::patch::numbers::Numbers;

/// Returns whether a triangle is neither inverted nor flat, by its rounded area.
#[inline(always)]
pub(crate) fn is_positive<T: Numbers>(corner: &Corner<T>) -> T::Mask {
    let area = corner.doubled_area();
    area.constant(0.0).lt(area)
}

/// Returns whether the inverse mean ratio of a triangle with positive area is at most `max_imr`.
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

/// Returns whether the inverse mean ratio of a triangle is no larger than `before` a move. The area `now` must be
/// positive.
#[inline(always)]
pub(crate) fn is_no_worse<T: Numbers>(
    formulas: impl Formulas,
    before: &Corner<T>,
    now: &Corner<T>,
) -> T::Mask {
    let (numerator, area) = formulas.inverse_mean_ratio(now);
    let (numerator_before, area_before) = formulas.inverse_mean_ratio(before);
    (numerator * area_before).le(numerator_before * area)
}

/// Returns whether a moved triangle has positive area, and an inverse mean ratio of at most `guard` or of at most the
/// ratio `before` the move.
pub(crate) fn is_kept(before: &Corner<f64>, now: &Corner<f64>, guard: f64) -> bool {
    is_positive(now) && (is_within(OfEdges, now, guard) || is_no_worse(OfEdges, before, now))
}

/// Distance of a vertex from the center of its disc, as a share of the radius, from which the vertex counts as at the
/// circle.
pub(crate) const AT_DISC: f64 = 1.0 - 1e-6;

/// Least curvature along a circle, as a share of the largest curvature, by which a step along the circle is divided.
pub(crate) const MIN_CIRCLE_CURVATURE: f64 = 1e-3;

/// Least growth of an altitude below the least altitude in a move. A larger factor than the rounding of altitudes, so that a
/// triangle below the least altitude cannot become lower in many moves.
pub(crate) const GROWTH: f64 = 1.0 + 1e-12;

/// Returns whether a moved triangle has an altitude of at least `least_altitude`, or a larger altitude than before the move.
pub(crate) fn keeps_altitude(least_altitude: f64, before: [DVec2; 3], now: [DVec2; 3]) -> bool {
    let now_high = altitude(now);
    now_high >= least_altitude || now_high >= altitude(before) * GROWTH || now == before
}

/// A circle that limits the moves of a vertex; an infinite radius stands for no limit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Circle {
    pub(crate) center: DVec2,
    pub(crate) radius: f64,
}

impl Circle {
    /// Returns whether a point is inside or on the circle.
    pub(crate) fn contains(self, at: DVec2) -> bool {
        !self.radius.is_finite() || at.distance(self.center) <= self.radius
    }

    /// Returns `to`, or the nearest point of the circle if `to` is outside.
    pub(crate) fn nearest(self, to: DVec2) -> DVec2 {
        let distance = to.distance(self.center);
        if distance <= self.radius {
            to
        } else {
            self.center + (to - self.center) * (self.radius / distance)
        }
    }

    /// Returns the position `to`, or the position nearest in the coordinates of the mesh if `to` is outside. The circle is
    /// in these coordinates.
    pub(crate) fn nearest_position(self, coordinates: MeshCoordinates, to: DVec2) -> DVec2 {
        let at = coordinates.at(to);
        let nearest = self.nearest(at);
        if nearest == at { to } else { coordinates.position(nearest) }
    }
}
