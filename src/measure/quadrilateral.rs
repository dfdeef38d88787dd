//! A quadrilateral in the form from which quality measures are computed.

use std::cell::OnceCell;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use crate::measure::edges::WorstEdges;
use crate::measure::triangle::{
    Triangle, difference, dot, largest, length, power_of_two, scaled, unbounded,
};
use crate::metric::{Metric, opposite_angles};
use crate::topology::predicates::orientation;

/// The quantities of a quadrilateral from which measures are computed. Lengths are divided by a power of two near the size of
/// the quadrilateral, so that no product of lengths overflows or vanishes.
pub(crate) struct Quadrilateral {
    /// Vectors from each vertex to the next.
    sides: [[f64; 2]; 4],
    lengths: [f64; 4],
    /// Squared lengths of both diagonals.
    diagonals: [f64; 2],
    /// Twice the signed area of the corner triangle of each vertex, with an exact sign.
    doubled_areas: [f64; 4],
    /// The corner triangles of the vertices, for metrics.
    corners: [Triangle; 4],
    /// Largest ratio of areas between the quadrilateral and a neighbor. NaN if the measure is not asked for.
    pub(crate) size_ratio: f64,
    /// The worst values of the edges. `None` if no measure of edges is asked for.
    pub(crate) worst_edges: Option<WorstEdges>,
    /// Smallest and largest angle in degrees. Computed on first use, as angles take longer than all other quantities.
    angles: OnceCell<[f64; 2]>,
}

impl Quadrilateral {
    /// Makes the quadrilateral with its vertices at `points`, counter-clockwise unless inverted. `lengths` are the lengths on the
    /// surface of a unit of each coordinate. `corners` are the corner triangles of the vertices. A quadrilateral with infinite or
    /// NaN coordinates is measured like a point.
    pub(crate) fn new(points: [[f64; 2]; 4], lengths: [f64; 2], corners: [Triangle; 4]) -> Self {
        let (points, _) = scaled(points).unwrap_or(([[0.0; 2]; 4], 1.0));
        let to = |from: usize, to: usize| {
            let [x, y] = difference(points[from], points[to]);
            [x * lengths[0], y * lengths[1]]
        };
        let sides = [0, 1, 2, 3].map(|k| to(k, (k + 1) % 4));
        let shrink = 1.0 / power_of_two(largest(sides.as_flattened()));
        let sides = sides.map(|side| side.map(|x| x * shrink));
        let diagonals = [to(0, 2), to(1, 3)].map(|diagonal| {
            let diagonal = diagonal.map(|x| x * shrink);
            dot(diagonal, diagonal)
        });
        // All factors are positive and keep the sign.
        let doubled_area = |k: u32| {
            orientation(&points, &[k, (k + 1) % 4, (k + 3) % 4])
                * (lengths[0] * shrink)
                * (lengths[1] * shrink)
        };
        Self {
            sides,
            lengths: sides.map(length),
            diagonals,
            doubled_areas: [0, 1, 2, 3].map(doubled_area),
            corners,
            size_ratio: f64::NAN,
            worst_edges: None,
            angles: OnceCell::new(),
        }
    }

    /// Returns the smallest and the largest inner angle in degrees, up to 360; of a quadrilateral with a negative area, the
    /// angles of its mirror image.
    fn angles(&self) -> [f64; 2] {
        *self.angles.get_or_init(|| {
            if self.lengths.contains(&0.0) {
                return [0.0, 180.0];
            }
            let sign = if self.quadrupled_area() < 0.0 { -1.0 } else { 1.0 };
            let angle = |k: usize| {
                let cosine = -dot(self.sides[k], self.sides[(k + 3) % 4]);
                let angle = (sign * self.doubled_areas[k]).atan2(cosine);
                if angle < 0.0 { angle + TAU } else { angle }
            };
            let angles = [0, 1, 2, 3].map(angle);
            let least = angles.into_iter().fold(f64::INFINITY, f64::min);
            [least, largest(&angles)].map(f64::to_degrees)
        })
    }

    pub(crate) fn min_angle(&self) -> f64 {
        // The angles of a square may be rounded.
        self.angles()[0].min(90.0)
    }

    pub(crate) fn max_angle(&self) -> f64 {
        self.angles()[1].max(90.0)
    }

    pub(crate) fn skewness(&self) -> f64 {
        let [least, most] = self.angles();
        ((most - 90.0) / 90.0).max((90.0 - least) / 90.0).clamp(0.0, 1.0)
    }

    fn shortest(&self) -> f64 {
        self.lengths.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Returns four times the signed area: each point of a convex quadrilateral is in two corner triangles.
    fn quadrupled_area(&self) -> f64 {
        self.doubled_areas.iter().sum()
    }

    pub(crate) fn edge_ratio(&self) -> f64 {
        match self.shortest() {
            0.0 => f64::INFINITY,
            shortest => largest(&self.lengths) / shortest,
        }
    }

    pub(crate) fn aspect_ratio(&self) -> f64 {
        // The exact ratio is at least 1; a smaller value is due to rounding. So are smaller values of the ratios below.
        let perimeter: f64 = self.lengths.iter().sum();
        unbounded(largest(&self.lengths) * perimeter / self.quadrupled_area().abs()).max(1.0)
    }

    pub(crate) fn radius_ratio(&self) -> f64 {
        let squares: f64 = self.sides.as_flattened().iter().map(|x| x * x).sum();
        let longest = largest(&self.lengths);
        let longest = (longest * longest).max(largest(&self.diagonals));
        let areas = self.doubled_areas.map(f64::abs);
        let least = areas.into_iter().fold(f64::INFINITY, f64::min);
        unbounded((squares * longest).sqrt() * 0.5 * FRAC_1_SQRT_2 / least).max(1.0)
    }

    pub(crate) fn scaled_jacobian(&self) -> f64 {
        let of_corner = |k: usize| match self.lengths[k] * self.lengths[(k + 3) % 4] {
            0.0 => 0.0,
            product => self.doubled_areas[k] / product,
        };
        (0..4).map(of_corner).fold(f64::INFINITY, f64::min).clamp(-1.0, 1.0)
    }

    /// Returns the condition number of each corner: half the sum of its squared sides over twice its area. Infinite if the
    /// corner is not positive.
    fn conditions(&self) -> [f64; 4] {
        [0, 1, 2, 3].map(|k: usize| {
            let (next, previous) = (self.sides[k], self.sides[(k + 3) % 4]);
            match self.doubled_areas[k] > 0.0 {
                true => (dot(next, next) + dot(previous, previous)) / (2.0 * self.doubled_areas[k]),
                false => f64::INFINITY,
            }
        })
    }

    pub(crate) fn condition(&self) -> f64 {
        largest(&self.conditions()).max(1.0)
    }

    pub(crate) fn shape(&self) -> f64 {
        1.0 / self.condition()
    }

    pub(crate) fn med_aspect_frobenius(&self) -> f64 {
        (self.conditions().iter().sum::<f64>() / 4.0).max(1.0)
    }

    /// Returns the root of the mean of q² over the corners, with the term of opposite angles if the metric has it; infinite if the metric has a barrier and a corner is not positive.
    pub(crate) fn metric(&self, metric: Metric) -> f64 {
        let squares = self.corners.each_ref().map(|corner| corner.squared_metric(metric, true));
        let mut squared = squares.iter().sum::<f64>() / 4.0;
        if metric.joins_opposite_angles() && squared.is_finite() {
            let cotangent = |corner: &Triangle| opposite_angles::cotangent(&corner.corner(true));
            squared += opposite_angles::of_cotangents(self.corners.each_ref().map(cotangent));
        }
        squared.sqrt()
    }
}
