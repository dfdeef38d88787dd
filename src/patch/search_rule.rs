//! The constants of all searches along a direction at one vertex, side by side.

/// The rule of a search: which lengths are tried in turn, and which trial is accepted. Each search of this library is
/// a constant here; fields that depend on the metric or on the sweep are set by the caller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SearchRule {
    /// The length of the first trial, in units of the direction.
    pub(crate) first_length: f64,
    /// Number of trials after which the vertex is left where it is.
    pub(crate) trials: u32,
    /// Factor on the length after a trial that does not decrease the objective enough.
    pub(crate) shorten: f64,
    /// Factor on the length after a trial that leaves an unacceptable triangle.
    pub(crate) shorten_infeasible: f64,
    /// Share of the predicted decrease that a trial must reach (Armijo); `None` to accept any objective.
    pub(crate) sufficient_decrease: Option<f64>,
    /// Increase of the objective that counts as rounding, as a share of the sum of q² over the patch.
    pub(crate) slack: f64,
    /// The eigenvalues of a Hessian are raised to at least this share of the larger.
    pub(crate) eigenvalue_floor: f64,
    /// The largest factor on the first length where nearly flat triangles make up most of the objective; see
    /// [`FLAT_EXPONENT`]. `None` for objectives without a barrier.
    pub(crate) max_lengthening: Option<f64>,
}

impl SearchRule {
    /// The search of a sweep over the free vertices, on the CPU and on a device. The caller sets the first length (the
    /// over-relaxation), the eigenvalue floor and the lengthening; a quadratic metric needs no decrease.
    pub(crate) const SWEEP: Self = Self {
        first_length: 1.0,
        trials: 8,
        shorten: 0.5,
        shorten_infeasible: 0.25,
        sufficient_decrease: Some(SUFFICIENT_DECREASE),
        // The rounding of a patch's objective in single precision. The CPU engine allows for it too, so that both
        // engines accept the same steps.
        slack: 1e-6,
        eigenvalue_floor: 0.0,
        max_lengthening: None,
    };

    /// The search along a curve. It is made in double precision alone, so it allows for less rounding.
    pub(crate) const CURVE: Self = Self { slack: 1e-12, ..Self::SWEEP };

    /// The search of a vertex at the bound of its move. The vertex moves along its bound, where the slope of the
    /// direction predicts no decrease, so any decrease is accepted.
    pub(crate) const BOUND: Self =
        Self { shorten_infeasible: 0.5, sufficient_decrease: Some(0.0), slack: 0.0, ..Self::SWEEP };

    /// The search that improves the worst triangles, by a p-norm with a Hessian that is nearly singular.
    pub(crate) const WORST: Self =
        Self { shorten_infeasible: 0.5, slack: 0.0, eigenvalue_floor: 1e-6, ..Self::SWEEP };

    /// The search that untangles. Its energy is finite for every triangle, so no trial is unacceptable.
    pub(crate) const UNTANGLE: Self =
        Self { trials: 10, slack: 0.0, eigenvalue_floor: 1e-3, ..Self::SWEEP };
}

/// Share of the predicted decrease that a trial must reach (Armijo).
pub(crate) const SUFFICIENT_DECREASE: f64 = 1e-4;

/// Around nearly flat triangles the objective E of a patch goes as 1/d², with d their altitude, and a Newton step makes
/// d larger by a third at most. The search then minimizes -E^(1 - 1.4), which is nearly linear in d and has the same
/// minima. The Newton step of -E^(1 - 1.4) has the same direction and 1 / (1 - 1.4 r) times the length, with
/// r = gᵀH⁻¹g / E.
pub(crate) const FLAT_EXPONENT: f64 = 1.4;
/// The least r from which steps are lengthened. r is 2/3 for E = 1/d², and at most 1/2 for E = 1/d.
pub(crate) const FLAT_RATIO: f64 = 0.6;
/// The least sum of q² around a vertex from which steps are lengthened: a triangle has an inverse mean ratio of a
/// thousand. Less flat triangles open in a few steps of Newton's own length.
pub(crate) const LEAST_FLAT: f64 = 1e6;
/// The shortest first trial next to a nearly flat triangle, on the CPU alone: 2⁻⁴⁶ of the larger coordinate, which is
/// 128 units in its last place. Shorter moves would be rounded away. A device is given no triangles so flat.
pub(crate) const LEAST_MOVE: f64 = 1.0 / (1u64 << 46) as f64;
