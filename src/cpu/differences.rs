//! Derivatives by forward differences, as in Mesquite, to test the cost model of Park & Shontz.

use crate::metric::{Corner, Dual, EdgeSlopes, Formulas, Real, Smoothing};
use crate::patch::LanePatch;
use crate::patch::numbers::Numbers;
use crate::run::line_search;

/// Returns the objectives of patches with their gradients and Hessians, by forward differences.
#[inline(always)]
pub(crate) fn derivatives<T: Numbers>(
    rings: &impl LanePatch<T>,
    formulas: impl Formulas,
    at: [T; 2],
    smoothing: Smoothing,
) -> Dual<T> {
    let width = least_height(rings, at) * line_search::DIFFERENCE;
    let zero = at[0].constant(0.0);
    let mut sum = Dual { value: zero, gradient: [zero; 2], hessian: [zero; 3] };
    for i in 0..rings.count() {
        let corner = rings.corner(i, at);
        let term = differences(formulas, &corner, rings.slopes(i), smoothing, width);
        sum = sum + rings.weighted(i, term);
    }
    sum
}

/// Returns the least distance of each vertex from a line through an outer edge of its patch.
#[inline(always)]
fn least_height<T: Numbers>(rings: &impl LanePatch<T>, at: [T; 2]) -> T {
    let mut least = at[0].constant(f64::INFINITY);
    for i in 0..rings.count() {
        let c = rings.corner(i, at);
        let [x, y] = [c.b[0] - c.a[0], c.b[1] - c.a[1]];
        least = Real::min(least, c.doubled_area() / Real::sqrt(x * x + y * y));
    }
    least
}

/// Returns value, gradient and Hessian of the model of a triangle, by forward differences of width `h`.
#[inline(always)]
fn differences<T: Numbers>(
    formulas: impl Formulas,
    corner: &Corner<T>,
    edges: impl EdgeSlopes,
    smoothing: Smoothing,
    h: T,
) -> Dual<T> {
    let (alpha, beta) = (edges.alpha(), edges.beta());
    let mut values = [h; 16];
    let displacements = std::hint::black_box(line_search::DISPLACEMENTS);
    for k in 0..16 {
        let [x, y] = displacements[k];
        let (x, y) = (h * f64::from(x), h * f64::from(y));
        let a = [corner.a[0] + x * alpha, corner.a[1] + y * alpha];
        let b = [corner.b[0] + x * beta, corner.b[1] + y * beta];
        values[k] = formulas.model(&Corner { a, b, ..*corner }, smoothing);
    }
    // Gradients at the vertex, and at points one step along x and along y, each by forward differences.
    let [here_x, here_y] = [(values[1] - values[0]) / h, (values[2] - values[0]) / h];
    let [right_x, right_y] = [(values[5] - values[4]) / h, (values[6] - values[4]) / h];
    let [up_x, up_y] = [(values[9] - values[8]) / h, (values[10] - values[8]) / h];
    Dual {
        value: values[0],
        gradient: [here_x, here_y],
        hessian: [
            (right_x - here_x) / h,
            ((right_y - here_y) + (up_x - here_x)) * 0.5 / h,
            (up_y - here_y) / h,
        ],
    }
}
