//! The metric AREA, the relative deviation of the area from the mean.

use crate::metric::corner::Invariants;
use crate::metric::dual::Real;
use crate::metric::properties::Properties;
use crate::metric::slopes::InvariantSlopes;

pub(super) const PROPERTIES: Properties = Properties {
    name: "area",
    formula: "|S - S_mean| / S_mean",
    citation: "Wang & Marek-Sadowska, DATE '03 (2003); Park & Shontz, Table 1, divided by the mean so that it has no dimension",
    purpose: "evens out areas and pays no attention to shape: angles of a few degrees are common, bounded by the shape guard only",
    barrier: false,
    ideal: 0.0,
    least: 0.0,
    scale_invariant: false,
    has_size_weight: false,
    is_inverse_mean_ratio: false,
    quadratic: true,
    eigenvalue_floor: 1e-3,
    shape_guard: 30.0,
    omega: 1.9,
    is_corrected: false,
    wgsl: include_str!("area.wgsl"),
};

/// Returns q² for q = |area / mean - 1|.
#[inline(always)]
pub(super) fn value<T: Real>(t: &Invariants<T>) -> T {
    let q = (t.area - t.mean) * (1.0 / t.mean);
    q * q
}

/// Returns [`value`] and its derivatives by the invariants.
#[inline(always)]
pub(super) fn slopes<T: Real>(t: &Invariants<T>) -> InvariantSlopes<T> {
    let q = (t.area - t.mean) * (1.0 / t.mean);
    InvariantSlopes {
        unit: q.constant(1.0 / t.mean),
        value: q * q,
        excess: None,
        area: Some(q * 2.0),
        excess_area: None,
        area_area: Some(q.constant(2.0)),
    }
}
