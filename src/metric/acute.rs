//! The metric ACUTE, for solvers with unknowns at circumcenters: the inverse mean ratio, with penalties on nearly right,
//! obtuse and small angles.

use crate::metric::corner::Corner;
use crate::metric::dual::{Dual, Real};
use crate::metric::edge_slopes::EdgeSlopes;
use crate::metric::properties::Properties;
use crate::metric::slopes::Slopes;
use crate::metric::{angles, imr};

pub(super) const PROPERTIES: Properties = Properties {
    name: "acute",
    formula: "sqrt(imr² + 300 Σ ψ(0.2 - cot) + 30 Σ ψ(cot - 1.3)), ψ(x) = x³ / 0.6 up to x = 0.2, quadratic beyond",
    citation: "imr² = (Σ cot² + 2) / 3 as in imr, and gpu-smooth's own penalties on the cotangents of the angles",
    purpose: "orthogonal meshes for solvers with unknowns at circumcenters: acute angles first, then well-shaped triangles",
    barrier: true,
    ideal: 1.0,
    least: 1.0,
    scale_invariant: true,
    has_size_weight: false,
    is_inverse_mean_ratio: false,
    quadratic: false,
    eigenvalue_floor: 1e-3,
    shape_guard: f64::INFINITY,
    omega: 1.9,
    is_corrected: true,
    wgsl: include_str!("acute.wgsl"),
};

/// Factor of imr² - 1 at a corner of a quadrilateral, so that shapes give way to orthogonal edges.
const SHAPE_OF_RIGHT: f64 = 0.3;

/// Returns q² - 1.
#[inline(always)]
pub(super) fn excess<T: Real>(t: &Corner<T>) -> T {
    let shape = imr::value(&t.invariants());
    let shape = if t.ideal.is_right { shape * SHAPE_OF_RIGHT } else { shape };
    shape + angles::value(t)
}

/// Returns value, gradient and Hessian of [`excess`] with respect to the visited vertex. `edges` has the slopes of the
/// edges by the position of the vertex.
#[inline(always)]
pub(super) fn expansion<T: Real, E: EdgeSlopes>(t: &Corner<T>, edges: E) -> Dual<T> {
    let shape = imr::slopes(&t.invariants()).expansion(t, edges);
    let is_right = !E::IS_OWN && t.ideal.is_right;
    let shape = if is_right { shape * SHAPE_OF_RIGHT } else { shape };
    shape + angles::expansion(t, edges)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::{Ideal, Metric};

    fn corner(a: [f64; 2], b: [f64; 2]) -> Corner<f64> {
        Corner { a, b, ideal: Ideal::of_area(1.0) }
    }

    #[test]
    fn between_38_and_78_degrees_the_metric_is_the_inverse_mean_ratio() {
        let good = corner([1.0, 0.0], [0.45, 0.75]);
        assert_eq!(Metric::Acute.quality(&good), Metric::Imr.quality(&good));
        let right = corner([1.0, 0.0], [0.0, 1.0]);
        // At the right angle, the ramp of 0.2 ends: ψ = 0.2² / 3.
        let expected = (4.0 / 3.0 + 300.0 * 0.04 / 3.0f64).sqrt();
        assert!((Metric::Acute.quality(&right) - expected).abs() < 1e-14);
        let thin = corner([1.0, 0.0], [0.5, 3.0]);
        assert!(Metric::Acute.quality(&thin) > 2.0 * Metric::Imr.quality(&thin));
    }
}
