//! The interface between the control of Newton steps and the engine, which takes one step in one call.

/// How an engine takes a Newton step of all vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepRequest {
    /// Share of the model's gain within which conjugate gradients solve for the step.
    pub(crate) forcing: f64,
    /// Gain as a share of f below which conjugate gradients need not go.
    pub(crate) least_gain: f64,
    /// Smallest Ritz value that any solution of the run has shown.
    pub(crate) least_ritz: f64,
    /// Whether negative curvatures count that come from the bend of curves on which vertices slide.
    pub(crate) is_exact: bool,
}

/// A Newton step of all vertices that an engine has taken after a sweep. Objectives are mean excesses, f - ideal² of the
/// base metric, and gains are in their unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NewtonStep {
    /// Mean excess after the sweep, before the step.
    pub(crate) swept: f64,
    /// Mean excess after the step.
    pub(crate) excess: f64,
    /// Gain of the quadratic model at the whole step.
    pub(crate) model_gain: f64,
    /// Bound of the model's gain beyond the whole step.
    pub(crate) bound: f64,
    /// Smallest Ritz value of the solution; infinite without iterations.
    pub(crate) least_ritz: f64,
    /// Length of the step, 1 for the whole step. 0 if no length lowered f.
    pub(crate) length: f64,
    /// Whether conjugate gradients met negative curvature, and ended there.
    pub(crate) is_curved_down: bool,
    /// Whether a longer step would invert a triangle or break the shape guard.
    pub(crate) is_broken: bool,
    /// Whether the model has all curvatures that come from the bend of curves.
    pub(crate) is_exact: bool,
    /// Number of sliding vertices that stayed at a bound.
    pub(crate) held: usize,
    /// Number of iterations of conjugate gradients.
    pub(crate) iterations: u32,
}
