//! A triangle in the form from which quality measures are computed.

use std::cell::OnceCell;
use std::f64::consts::PI;

use crate::measure::edges::WorstEdges;
use crate::metric::{Corner, Ideal, Metric};
use crate::topology::predicates::orientation;

/// The longest edge of an equilateral triangle divided by the radius of the circle of equal area, sqrt(4π / √3).
pub(crate) const LEAST_SKEWNESS: f64 = 2.693_547_374_177_197;

const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// The quantities of a triangle from which measures are computed. Lengths are divided by a power of two near the size
/// of the triangle, so that no product of lengths overflows or vanishes. Only `size_ratio` and some metrics depend on
/// the size.
pub(crate) struct Triangle {
    /// Edge vectors between the corners: 0 to 1, 0 to 2, and 1 to 2.
    edges: [[f64; 2]; 3],
    lengths: [f64; 3],
    /// Twice the signed area, with an exact sign.
    doubled_area: f64,
    /// Mean area of the mesh. `per_unit` is the scale factor that was applied to lengths.
    mean_area: f64,
    per_unit: f64,
    /// Smallest and largest angle in degrees. Computed on first use, as angles take longer than all other quantities.
    angles: OnceCell<[f64; 2]>,
    /// Value of the measure `size-ratio`, which depends on neighbors.
    pub(crate) size_ratio: f64,
    /// The worst values of the triangle's edges; `None` if no measure needs them.
    pub(crate) worst_edges: Option<WorstEdges>,
}

/// Returns the largest power of two that is at most `x`, but no less than the smallest normal number, whose inverse is
/// finite.
#[inline]
pub(crate) fn power_of_two(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    f64::from_bits(x.to_bits() & EXPONENT).max(f64::MIN_POSITIVE)
}

#[inline]
pub(crate) fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |most, x| most.max(x.abs()))
}

#[inline]
pub(crate) fn difference(p: [f64; 2], q: [f64; 2]) -> [f64; 2] {
    [q[0] - p[0], q[1] - p[1]]
}

#[inline]
pub(crate) fn dot(u: [f64; 2], v: [f64; 2]) -> f64 {
    u[0] * v[0] + u[1] * v[1]
}

/// Returns the length of an edge, also where squares of its components vanish.
#[inline]
pub(crate) fn length(edge: [f64; 2]) -> f64 {
    match dot(edge, edge).sqrt() {
        length if length > 1e-140 => length,
        _ => edge[0].hypot(edge[1]),
    }
}

/// Returns the vertices of an element, scaled by a power of two if differences or products of coordinates could overflow or
/// vanish, and the factor of the scaling. `None` if a coordinate is infinite or NaN.
#[inline]
pub(crate) fn scaled<const N: usize>(mut points: [[f64; 2]; N]) -> Option<([[f64; 2]; N], f64)> {
    if !points.as_flattened().iter().all(|x| x.is_finite()) {
        return None;
    }
    let far = largest(points.as_flattened());
    let mut per_unit = 1.0;
    if !(1e-100..1e100).contains(&far) {
        per_unit = 1.0 / power_of_two(far);
        points = points.map(|point| point.map(|x| x * per_unit));
    }
    Some((points, per_unit))
}

impl Triangle {
    /// Returns a triangle that has shrunk to a point. Triangles with infinite or NaN coordinates are measured like a
    /// point.
    fn point(size_ratio: f64) -> Self {
        Self {
            edges: [[0.0; 2]; 3],
            lengths: [0.0; 3],
            doubled_area: 0.0,
            mean_area: 1.0,
            per_unit: 1.0,
            angles: OnceCell::new(),
            size_ratio,
            worst_edges: None,
        }
    }

    /// Makes the triangle with its corners at `points`, counter-clockwise unless inverted. `lengths` are the lengths on
    /// the surface of a unit of each coordinate. `mean_area` is the mean area of the mesh, `size_ratio` the value of
    /// the measure.
    #[inline]
    pub(crate) fn new(
        points: [[f64; 2]; 3],
        lengths: [f64; 2],
        mean_area: f64,
        size_ratio: f64,
    ) -> Self {
        let Some((points, per_unit)) = scaled(points) else { return Self::point(size_ratio) };
        let [p, q, r] = points;
        let edges = [difference(p, q), difference(p, r), difference(q, r)];
        let edges = edges.map(|[x, y]| [x * lengths[0], y * lengths[1]]);
        let size = largest(edges.as_flattened());
        if size == 0.0 {
            return Self::point(size_ratio);
        }
        let shrink = 1.0 / power_of_two(size);
        let edges = edges.map(|edge| edge.map(|x| x * shrink));
        Self {
            edges,
            lengths: edges.map(length),
            // Both factors are positive and keep the sign.
            doubled_area: orientation(&points, &[0, 1, 2])
                * (lengths[0] * shrink)
                * (lengths[1] * shrink),
            mean_area,
            per_unit: per_unit * shrink,
            angles: OnceCell::new(),
            size_ratio,
            worst_edges: None,
        }
    }

    /// Returns the smallest and the largest angle in degrees; for an inverted triangle, the angles of its mirror image.
    #[inline]
    fn angles(&self) -> [f64; 2] {
        *self.angles.get_or_init(|| {
            if self.lengths.contains(&0.0) {
                return [0.0, 180.0];
            }
            // The cotangent of each angle is a dot product over the doubled area. The largest cotangent belongs to the
            // smallest angle.
            let [a, b, c] = self.edges;
            let [u, v, w] = [dot(a, b), -dot(a, c), dot(b, c)];
            let area = self.doubled_area.abs();
            [u.max(v).max(w), u.min(v).min(w)].map(|dot| area.atan2(dot).to_degrees())
        })
    }

    pub(crate) fn min_angle(&self) -> f64 {
        self.angles()[0]
    }

    pub(crate) fn max_angle(&self) -> f64 {
        self.angles()[1]
    }

    fn longest(&self) -> f64 {
        largest(&self.lengths)
    }

    fn perimeter(&self) -> f64 {
        self.lengths.iter().sum()
    }

    fn squares(&self) -> f64 {
        self.edges.as_flattened().iter().map(|x| x * x).sum()
    }

    pub(crate) fn edge_ratio(&self) -> f64 {
        let [a, b, c] = self.lengths;
        match a.min(b).min(c) {
            0.0 => f64::INFINITY,
            shortest => self.longest() / shortest,
        }
    }

    pub(crate) fn aspect_ratio(&self) -> f64 {
        // The exact ratio is at least 1; a smaller value is due to rounding.
        unbounded(self.longest() * self.perimeter() / (2.0 * SQRT_3 * self.doubled_area.abs()))
            .max(1.0)
    }

    pub(crate) fn radius_ratio(&self) -> f64 {
        let [a, b, c] = self.lengths;
        let area = self.doubled_area.abs();
        unbounded((a * b / area) * (c * self.perimeter() / area) / 4.0).max(1.0)
    }

    pub(crate) fn scaled_jacobian(&self) -> f64 {
        let [a, b, c] = self.lengths;
        match (a * b).max(b * c).max(c * a) {
            0.0 => 0.0,
            most => (2.0 / SQRT_3 * self.doubled_area / most).clamp(-1.0, 1.0),
        }
    }

    pub(crate) fn condition(&self) -> f64 {
        match self.doubled_area > 0.0 {
            true => (self.squares() / (2.0 * SQRT_3 * self.doubled_area)).max(1.0),
            false => f64::INFINITY,
        }
    }

    pub(crate) fn shape(&self) -> f64 {
        1.0 / self.condition()
    }

    pub(crate) fn skewness(&self) -> f64 {
        let [least, most] = self.angles();
        ((most - 60.0) / 120.0).max((60.0 - least) / 60.0).clamp(0.0, 1.0)
    }

    pub(crate) fn schism_skewness(&self) -> f64 {
        let radius = (self.doubled_area.abs() / 2.0 / PI).sqrt();
        unbounded(self.longest() / radius).max(LEAST_SKEWNESS)
    }

    /// Returns the value q of a metric, infinite if the metric has a barrier and the triangle is inverted or flat.
    pub(crate) fn metric(&self, metric: Metric) -> f64 {
        self.squared_metric(metric, false).sqrt()
    }

    /// Returns q² of a metric, infinite if the metric has a barrier and the triangle is inverted or flat. If the triangle
    /// `is_right`, it is the corner triangle of the first vertex in a quadrilateral, whose ideal is a square.
    #[inline]
    pub(crate) fn squared_metric(&self, metric: Metric, is_right: bool) -> f64 {
        let is_positive = self.doubled_area > 0.0;
        if metric.properties().barrier && !is_positive {
            return f64::INFINITY;
        }
        let corner = self.corner(is_right);
        let squared = metric.excess(&corner) + metric.ideal_squared();
        match squared.is_nan() {
            true => f64::INFINITY,
            false => squared.max(0.0),
        }
    }

    /// Returns the triangle as metrics see it; see [`squared_metric`](Self::squared_metric).
    #[inline]
    pub(super) fn corner(&self, is_right: bool) -> Corner<f64> {
        let is_positive = self.doubled_area > 0.0;
        let [a, b, _] = self.edges;
        let mean_area = self.mean_area * self.per_unit * self.per_unit;
        let mut corner = Corner { a, b, ideal: Ideal::of_area(mean_area) };
        if is_positive != (corner.doubled_area() > 0.0) {
            // Rounding has changed the sign of the area. With axes along and across the first edge, a single coordinate
            // determines the sign, and is set from the exact area.
            let length = self.lengths[0];
            corner.a = [length, 0.0];
            corner.b = [dot(a, b) / length, self.doubled_area / length];
        }
        if is_right { corner.of_right_angle() } else { corner }
    }
}

/// Returns `ratio`, or infinity where the ratio is NaN because numerator and denominator are both zero.
pub(crate) fn unbounded(ratio: f64) -> f64 {
    if ratio.is_nan() { f64::INFINITY } else { ratio }
}
