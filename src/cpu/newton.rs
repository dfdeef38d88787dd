//! One visit of a free vertex: a safeguarded Newton step on its patch, in double precision.

use glam::DVec2;

use crate::dual::Dual;
use crate::metric::{Corner, Metric};
use crate::plan::{Derivatives, line_search};

/// A free vertex with its one-ring.
#[derive(Clone, Copy)]
pub(crate) struct Patch<'a> {
    /// Neighbors, counter-clockwise.
    pub(crate) ring: &'a [u32],
    /// All positions.
    pub(crate) positions: &'a [DVec2],
    /// Mean area of the mesh's triangles.
    pub(crate) mean_area: f64,
}

/// How a visit steps.
#[derive(Clone, Copy)]
pub(crate) struct Step {
    pub(crate) omega: f64,
    pub(crate) inner: u32,
    pub(crate) sharpness: u32,
    pub(crate) derivatives: Derivatives,
}

impl Patch<'_> {
    /// The patch's triangles, seen from the vertex at `at`.
    #[inline(always)]
    fn corners(&self, at: DVec2) -> impl Iterator<Item = Corner<f64>> + '_ {
        let edge = move |v: u32| (self.positions[v as usize] - at).to_array();
        let next = self.ring.iter().skip(1).chain(self.ring.first());
        self.ring.iter().zip(next).map(move |(&a, &b)| Corner {
            a: edge(a),
            b: edge(b),
            mean_area: self.mean_area,
        })
    }

    /// Where the vertex goes from `at`.
    #[inline(always)]
    pub(crate) fn visit(&self, metric: Metric, mut at: DVec2, step: &Step) -> DVec2 {
        for _ in 0..step.inner {
            match self.newton_step(metric, at, step) {
                Some(to) => {
                    let moved = to.distance_squared(at);
                    let edge = self.positions[self.ring[0] as usize].distance_squared(at);
                    at = to;
                    let exact = step.derivatives == Derivatives::Analytic;
                    if exact && moved < line_search::SETTLED * line_search::SETTLED * edge {
                        break;
                    }
                }
                None => break,
            }
        }
        at
    }

    /// One Newton step with its line search; `None` if no step improves the patch.
    #[inline(always)]
    fn newton_step(&self, metric: Metric, at: DVec2, step: &Step) -> Option<DVec2> {
        let properties = metric.properties();
        let mut sum = Dual::default();
        let mut limit = properties.shape_guard * (1.0 - line_search::GUARD_RESERVE);
        let difference = match step.derivatives {
            Derivatives::Analytic => 0.0,
            Derivatives::FiniteDifference => line_search::DIFFERENCE * self.least_height(at),
        };
        for corner in self.corners(at) {
            if properties.shape_guard.is_finite() {
                limit = limit.max(inverse_mean_ratio(&corner));
            }
            sum = sum
                + match step.derivatives {
                    Derivatives::Analytic => metric.derivatives(&corner, step.sharpness),
                    Derivatives::FiniteDifference => {
                        differences(metric, &corner, step.sharpness, difference)
                    }
                };
        }
        let (direction, slope) = descent(&sum, properties.eigenvalue_floor)?;
        let squares = sum.value + self.ring.len() as f64 * metric.ideal_squared();

        let mut length = step.omega;
        for _ in 0..line_search::TRIALS {
            let to = at + direction * length;
            match self.objective(metric, to, step.sharpness, limit) {
                None => length *= line_search::SHORTEN_INFEASIBLE,
                Some(value) => {
                    let wanted = line_search::SUFFICIENT_DECREASE * length * slope;
                    if properties.quadratic
                        || value <= sum.value + wanted + line_search::SLACK * squares
                    {
                        return Some(to);
                    }
                    length *= line_search::SHORTEN;
                }
            }
        }
        None
    }

    /// The patch's objective with the vertex at `at`; `None` if a triangle is inverted or breaks
    /// the shape guard.
    #[inline(always)]
    fn objective(&self, metric: Metric, at: DVec2, sharpness: u32, limit: f64) -> Option<f64> {
        let mut sum = 0.0;
        for corner in self.corners(at) {
            if corner.doubled_area() <= 0.0
                || limit.is_finite() && inverse_mean_ratio(&corner) > limit
            {
                return None;
            }
            sum += metric.model(&corner, sharpness);
        }
        Some(sum)
    }

    /// The least distance of the vertex from the line through a ring edge.
    fn least_height(&self, at: DVec2) -> f64 {
        let height = |c: Corner<f64>| {
            let base = DVec2::from(c.b) - DVec2::from(c.a);
            c.doubled_area() / base.length()
        };
        self.corners(at).map(height).fold(f64::INFINITY, f64::min)
    }
}

/// The inverse mean ratio, for the shape guard.
#[inline(always)]
fn inverse_mean_ratio(corner: &Corner<f64>) -> f64 {
    Metric::Ar.quality(corner)
}

/// The direction -H⁻¹g, H made positive definite by absolute eigenvalues with a floor, and the slope
/// g·d along it. `None` where the objective is flat or not finite.
fn descent(at: &Dual, floor: f64) -> Option<(DVec2, f64)> {
    let [xx, xy, yy] = at.hessian;
    let scale = xx.abs().max(xy.abs()).max(yy.abs());
    if !(scale > 0.0 && scale.is_finite()) {
        return None;
    }
    let g = DVec2::from(at.gradient) / scale;
    let (xx, xy, yy) = (xx / scale, xy / scale, yy / scale);
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let radius = (half * half + xy * xy).sqrt();
    let (high, low) = ((mean + radius).abs(), (mean - radius).abs());
    let least = floor * high.max(low);
    let (high, low) = (high.max(least), low.max(least));
    // H = mean + R, R² = radius²: the projector on the upper eigenvector is (1 + R/radius)/2.
    let upper = if radius > 0.0 {
        0.5 * (g + DVec2::new(half * g.x + xy * g.y, xy * g.x - half * g.y) / radius)
    } else {
        g
    };
    let direction = -(upper / high + (g - upper) / low);
    let slope = direction.dot(g) * scale;
    (slope < 0.0).then_some((direction, slope))
}

/// Value, gradient and Hessian of the model by forward differences of width `h`.
#[inline(always)]
fn differences(metric: Metric, corner: &Corner<f64>, sharpness: u32, h: f64) -> Dual {
    let mut values = [0.0; 16];
    for (value, [x, y]) in values.iter_mut().zip(std::hint::black_box(line_search::DISPLACEMENTS)) {
        let d = [f64::from(x) * h, f64::from(y) * h];
        let moved = |e: [f64; 2]| [e[0] - d[0], e[1] - d[1]];
        let corner = Corner { a: moved(corner.a), b: moved(corner.b), ..*corner };
        *value = metric.model(&corner, sharpness);
    }
    // Gradients here and one step along x and y, each from a value and its forward neighbors.
    let gradient = |k: usize| [(values[k + 1] - values[k]) / h, (values[k + 2] - values[k]) / h];
    let (here, right, up) = (gradient(0), gradient(4), gradient(8));
    Dual {
        value: values[0],
        gradient: here,
        hessian: [
            (right[0] - here[0]) / h,
            0.5 * ((right[1] - here[1]) + (up[0] - here[0])) / h,
            (up[1] - here[1]) / h,
        ],
    }
}
