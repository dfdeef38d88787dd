//! The constants of all line searches for the step of a vertex, side by side.

/// Parameters of a line search: the lengths of trials, and the condition by which a trial is accepted. Sweeps, sliding,
/// worst triangles and untangling have a constant each. Callers replace fields that depend on a metric or a
/// sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SearchRule {
    /// Length of the first trial; 1 is a full Newton step.
    pub(crate) first_length: f64,
    /// Largest number of trials. If no trial is accepted, the vertex stays.
    pub(crate) trials: u32,
    /// Factor on the length after a trial that does not decrease the objective enough.
    pub(crate) shorten: f64,
    /// Factor on the length after a trial that leaves an unacceptable triangle.
    pub(crate) shorten_infeasible: f64,
    /// Share of the predicted decrease that a trial must reach (Armijo); `None` to accept any objective.
    pub(crate) sufficient_decrease: Option<f64>,
    /// Increase of the objective that counts as rounding, as a share of the sum of q² over the patch.
    pub(crate) slack: f64,
    /// Newton's method raises the smaller eigenvalue of a Hessian to this share of the larger eigenvalue.
    pub(crate) eigenvalue_floor: f64,
    /// The largest factor on the first length where nearly flat triangles make up most of the objective; see
    /// [`FLAT_EXPONENT`]. `None` for objectives without a barrier.
    pub(crate) max_lengthening: Option<f64>,
}

impl SearchRule {
    /// Sweeps over free vertices, on the CPU and on devices. The caller sets the first length (the
    /// over-relaxation), the eigenvalue floor and the lengthening; a quadratic metric needs no decrease.
    pub(crate) const SWEEP: Self = Self {
        first_length: 1.0,
        trials: 8,
        shorten: 0.5,
        shorten_infeasible: 0.25,
        sufficient_decrease: Some(SUFFICIENT_DECREASE),
        // The slack allows for the rounding of a patch's objective in single precision. The CPU engine has the same
        // slack, so that both engines accept equal steps.
        slack: 1e-6,
        eigenvalue_floor: 0.0,
        max_lengthening: None,
    };

    /// Sliding along a curve in double precision, so the slack is smaller than in sweeps. Devices slide vertices with the
    /// slack of sweeps.
    pub(crate) const CURVE: Self = Self { slack: 1e-12, ..Self::SWEEP };

    /// Improvement of the worst triangles. The Hessians of p-norms are nearly singular, so the eigenvalue floor is low.
    pub(crate) const WORST: Self =
        Self { shorten_infeasible: 0.5, slack: 0.0, eigenvalue_floor: 1e-6, ..Self::SWEEP };

    /// Untangling. The energy is finite for inverted triangles too, so every trial is feasible.
    pub(crate) const UNTANGLE: Self =
        Self { trials: 10, slack: 0.0, eigenvalue_floor: 1e-3, ..Self::SWEEP };
}

/// Share of the predicted decrease that a trial must reach (Armijo).
pub(crate) const SUFFICIENT_DECREASE: f64 = 1e-4;

/// Exponent of the objective that lengthens steps around nearly flat triangles. There the objective E of a patch goes
/// as 1/d², with d the altitude of the triangles, and a Newton step makes d larger by a third at most. The search then
/// minimizes -E^(1 - 1.4), which is nearly linear in d and has the same minima. The Newton step of -E^(1 - 1.4) has the
/// same direction and 1 / (1 - 1.4 r) times the length, with r = gᵀH⁻¹g / E.
pub(crate) const FLAT_EXPONENT: f64 = 1.4;
/// Value of r above which steps are lengthened. r is 2/3 for E = 1/d², and at most 1/2 for E = 1/d.
pub(crate) const FLAT_RATIO: f64 = 0.6;
/// Sum of q² over a patch above which steps are lengthened: a triangle then has an inverse mean ratio of about a
/// thousand. Less flat triangles open in a few steps of Newton's own length.
pub(crate) const MIN_FLAT_SUM: f64 = 1e6;
/// Length of the shortest first trial next to a nearly flat triangle, on the CPU alone: 2⁻⁴⁶ of the larger coordinate,
/// which is 64 to 128 units in its last place. Shorter moves would be rounded away. Devices never sweep triangles of
/// this flatness.
pub(crate) const MIN_MOVE: f64 = 1.0 / (1u64 << 46) as f64;
