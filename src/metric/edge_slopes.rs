//! Slopes of the edges of a triangle by the position of the visited vertex.

/// The slopes of the two edges of a [`Corner`](crate::metric::Corner): if the visited vertex moves by d, the edges a and b
/// change by α d and β d.
///
/// A triangle whose edges start from the visited vertex has the slopes of [`Own`]. In a quadrilateral, the vertex is
/// also the end of one edge of each neighboring corner, with the slopes (1, 0) and (0, 1). In an element of second
/// order, slopes are derivatives of a shape function at a sample point.
pub(crate) trait EdgeSlopes: Copy {
    /// Returns the slope α of the edge a.
    fn alpha(self) -> f64;
    /// Returns the slope β of the edge b.
    fn beta(self) -> f64;

    /// Returns the slope β - α of the edge b - a.
    #[inline(always)]
    fn third(self) -> f64 {
        self.beta() - self.alpha()
    }
}

/// The slopes (-1, -1) of a triangle whose edges start from the visited vertex. The type has no size, so the compiler
/// folds both slopes into the formulas.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Own;

impl EdgeSlopes for Own {
    #[inline(always)]
    fn alpha(self) -> f64 {
        -1.0
    }

    #[inline(always)]
    fn beta(self) -> f64 {
        -1.0
    }
}

/// Any two slopes α and β, for tests.
#[cfg(test)]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given(pub(crate) f64, pub(crate) f64);

#[cfg(test)]
impl EdgeSlopes for Given {
    fn alpha(self) -> f64 {
        self.0
    }

    fn beta(self) -> f64 {
        self.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::table::Formulas;
    use crate::metric::{Corner, Dual, Ideal, Metric, Smoothing};

    const HALF_ROOT: f64 = 0.866_025_403_784_438_6;

    /// Maps the two edges of a square's corner to two edges of an equilateral triangle. Slopes of edges are mapped like
    /// the edges themselves.
    fn from_right_angle([a, b]: [f64; 2]) -> [f64; 2] {
        [a, 0.5 * a + HALF_ROOT * b]
    }

    /// Returns the corner of a quadrilateral at p, with edges to q and r.
    fn corner_of_quadrilateral([p, q, r]: [[f64; 2]; 3]) -> Corner<f64> {
        let [x, y] = [0, 1].map(|axis| from_right_angle([q[axis] - p[axis], r[axis] - p[axis]]));
        Corner { a: [x[0], y[0]], b: [x[1], y[1]], ideal: Ideal::of_area(0.6) }
    }

    fn numbers(dual: Dual) -> [f64; 6] {
        let ([x, y], [xx, xy, yy]) = (dual.gradient, dual.hessian);
        [dual.value, x, y, xx, xy, yy]
    }

    fn assert_close(found: Dual, expected: Dual, what: &dyn std::fmt::Debug) {
        let [found, expected] = [found, expected].map(numbers);
        let size = expected.iter().fold(1.0f64, |size, x| size.max(x.abs()));
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-11 * size, "{what:?}: {found} for {expected}");
        }
    }

    #[test]
    fn derivatives_by_any_slopes_are_those_of_dual_numbers() {
        let corner = Corner { a: [1.0, 0.2], b: [0.3, 1.4], ideal: Ideal::of_area(0.6) };
        // Without a penalty, which has no effect on smooth metrics.
        let smoothings = [0, 1, 3].map(Smoothing::of);
        for slopes in [(-1.0, -1.0), (1.0, 0.0), (0.0, 1.0), (0.3, -1.7), (0.0, 0.0)] {
            let slopes = Given(slopes.0, slopes.1);
            let edge = |[x, y]: [f64; 2], slope: f64| {
                [Dual::variable(x, 0, slope), Dual::variable(y, 1, slope)]
            };
            let (a, b) = (edge(corner.a, slopes.0), edge(corner.b, slopes.1));
            let dual = Corner { a, b, ideal: corner.ideal };
            for &metric in Metric::ALL {
                for smoothing in smoothings {
                    let found = metric.formulas().expansion(&corner, slopes, smoothing);
                    let expected = metric.formulas().model(&dual, smoothing);
                    assert_close(found, expected, &(metric, slopes, smoothing));
                }
            }
        }
    }

    #[test]
    fn the_slopes_of_own_give_the_bits_of_the_same_numbers_at_run_time() {
        let corner = Corner { a: [1.0, 0.2], b: [0.3, 1.4], ideal: Ideal::of_area(0.6) };
        for &metric in Metric::ALL {
            let smoothing = Smoothing { sharpness: 2, penalty_guard: 2.0 };
            let folded = metric.formulas().expansion(&corner, Own, smoothing);
            let [alpha, beta] = std::hint::black_box([-1.0, -1.0]);
            let given = metric.formulas().expansion(&corner, Given(alpha, beta), smoothing);
            assert_eq!(numbers(folded), numbers(given), "{metric}");
        }
    }

    #[test]
    fn slopes_of_a_quadrilateral_give_the_differences_of_its_corners() {
        // The visited vertex is the start of its own corner's edges, then the end of one edge of each neighboring
        // corner.
        let others = [[1.1, 0.1], [0.2, 0.9], [1.2, 1.3]];
        let own = |v: [f64; 2]| corner_of_quadrilateral([v, others[0], others[1]]);
        let next = |v: [f64; 2]| corner_of_quadrilateral([others[0], others[2], v]);
        let last = |v: [f64; 2]| corner_of_quadrilateral([others[1], v, others[2]]);
        type Seen<'a> = &'a dyn Fn([f64; 2]) -> Corner<f64>;
        let corners: [(Seen<'_>, [f64; 2]); 3] =
            [(&own, [-1.0, -1.0]), (&next, [0.0, 1.0]), (&last, [1.0, 0.0])];
        let (here, h) = ([0.1, -0.05], 1e-5);
        for (corner, slopes) in corners {
            let [alpha, beta] = from_right_angle(slopes);
            for &metric in Metric::ALL {
                let smoothing = Smoothing::of(2);
                let value = |x: f64, y: f64| {
                    let at = [here[0] + x * h, here[1] + y * h];
                    metric.formulas().model(&corner(at), smoothing)
                };
                let found =
                    metric.formulas().expansion(&corner(here), Given(alpha, beta), smoothing);
                let (mid, right, left) = (value(0.0, 0.0), value(1.0, 0.0), value(-1.0, 0.0));
                let (up, down) = (value(0.0, 1.0), value(0.0, -1.0));
                let cross =
                    value(1.0, 1.0) - value(1.0, -1.0) - value(-1.0, 1.0) + value(-1.0, -1.0);
                let per = 1.0 / (h * h);
                let hessian = [
                    (right - 2.0 * mid + left) * per,
                    0.25 * cross * per,
                    (up - 2.0 * mid + down) * per,
                ];
                let gradient = [(right - left) / (2.0 * h), (up - down) / (2.0 * h)];
                for (found, expected) in found.gradient.iter().zip(gradient) {
                    assert!((found - expected).abs() < 1e-7, "{metric}: {found} {expected}");
                }
                for (found, expected) in found.hessian.iter().zip(hessian) {
                    assert!((found - expected).abs() < 1e-4, "{metric}: {found} {expected}");
                }
            }
        }
    }
}
