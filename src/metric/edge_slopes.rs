//! Slopes of the edges of a triangle by the position of the visited vertex.

/// √3/2, the height of an equilateral triangle.
pub(super) const HEIGHT: f64 = 0.866_025_403_784_438_6;

/// The slopes of the two edges of a [`Corner`](crate::metric::Corner): if the visited vertex moves by d, the edges a and b
/// change by α d and β d.
///
/// A triangle whose edges start from the visited vertex has the slopes of [`Own`]. In a quadrilateral, the vertex is
/// also the end of one edge of each neighboring corner, with the slopes (1, 0) and (0, 1). In an element of second
/// order, slopes are derivatives of a shape function at a sample point.
pub(crate) trait EdgeSlopes: Copy {
    /// Whether the slopes are those of a triangle whose edges start from the visited vertex.
    const IS_OWN: bool;

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
    const IS_OWN: bool = true;

    #[inline(always)]
    fn alpha(self) -> f64 {
        -1.0
    }

    #[inline(always)]
    fn beta(self) -> f64 {
        -1.0
    }
}

/// Any two slopes α and β.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given(pub(crate) f64, pub(crate) f64);

impl Given {
    /// Returns the slopes of a sheared corner of a quadrilateral, given those of its edges; see
    /// [`of_right_angle`](crate::metric::of_right_angle).
    pub(crate) const fn of_right_angle(alpha: f64, beta: f64) -> Self {
        Self(alpha, 0.5 * alpha + HEIGHT * beta)
    }

    /// Returns the slopes of the edges of a corner of a quadrilateral, given those of the sheared corner.
    pub(crate) fn before_shear(edges: impl EdgeSlopes) -> Self {
        Self(edges.alpha(), (edges.beta() - 0.5 * edges.alpha()) * (1.0 / HEIGHT))
    }
}

impl EdgeSlopes for Given {
    const IS_OWN: bool = false;

    #[inline(always)]
    fn alpha(self) -> f64 {
        self.0
    }

    #[inline(always)]
    fn beta(self) -> f64 {
        self.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::table::Formulas;
    use crate::metric::{Corner, Dual, Ideal, Metric, Smoothing};

    /// Returns the corner of a quadrilateral at p, with edges to q and r.
    fn corner_of_quadrilateral([p, q, r]: [[f64; 2]; 3]) -> Corner<f64> {
        let [a, b] = [q, r].map(|end| [end[0] - p[0], end[1] - p[1]]);
        Corner { a, b, ideal: Ideal::of_area(0.6) }.of_right_angle()
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
        let triangle = Corner { a: [1.0, 0.2], b: [0.3, 1.4], ideal: Ideal::of_area(0.6) };
        derivatives_by_any_slopes(triangle);
        derivatives_by_any_slopes(triangle.of_right_angle());
    }

    fn derivatives_by_any_slopes(corner: Corner<f64>) {
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
            let slopes = Given::of_right_angle(slopes[0], slopes[1]);
            for &metric in Metric::ALL {
                let smoothing = Smoothing::of(2);
                let value = |x: f64, y: f64| {
                    let at = [here[0] + x * h, here[1] + y * h];
                    metric.formulas().model(&corner(at), smoothing)
                };
                let found = metric.formulas().expansion(&corner(here), slopes, smoothing);
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
                let size = found.hessian.iter().fold(1.0f64, |size, x| size.max(x.abs()));
                for (found, expected) in found.gradient.iter().zip(gradient) {
                    assert!((found - expected).abs() < 1e-7 * size, "{metric}: {found} {expected}");
                }
                for (found, expected) in found.hessian.iter().zip(hessian) {
                    assert!((found - expected).abs() < 1e-4 * size, "{metric}: {found} {expected}");
                }
            }
        }
    }
}
