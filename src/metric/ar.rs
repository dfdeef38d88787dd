//! The metric AR, the aspect ratio.

use crate::metric::corner::Invariants;
use crate::metric::dual::Real;
use crate::metric::properties::Properties;
use crate::metric::slopes::ShapeSlopes;

pub(super) const PROPERTIES: Properties = Properties {
    name: "ar",
    formula: "sqrt(3) (L12² + L23² + L13²) / (12 S)",
    citation: "Dompierre et al., An analysis of simplex shape measures for anisotropic meshes, CMAME 194 (2005); Park & Shontz, Table 1",
    purpose: "equal to imr for every triangle; kept apart because the paper times both",
    barrier: true,
    ideal: 1.0,
    least: 1.0,
    scale_invariant: true,
    has_size_weight: false,
    is_inverse_mean_ratio: true,
    quadratic: false,
    eigenvalue_floor: 1e-3,
    shape_guard: f64::INFINITY,
    omega: 1.9,
    is_corrected: true,
    wgsl: include_str!("ar.wgsl"),
};

/// Returns q² - 1 for q = (excess + area) / area. The numerator is √3/6 times the sum of the squared edge lengths.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Invariants<T>) -> T {
    let q = (t.excess + t.area) / t.area;
    (q - 1.0) * (q + 1.0)
}

/// Returns [`value`] and its derivatives by the shape m = excess / area.
#[inline(always)]
pub(super) fn slopes<T: Real>(t: &Invariants<T>) -> ShapeSlopes<T> {
    let inverse_area = t.area.constant(1.0) / t.area;
    let q = (t.excess + t.area) * inverse_area;
    ShapeSlopes {
        inverse_area,
        shape: t.excess * inverse_area,
        value: (q - 1.0) * (q + 1.0),
        first: q * 2.0,
        second: q.constant(2.0),
    }
}
