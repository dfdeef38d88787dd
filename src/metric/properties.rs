//! The properties of a metric.

/// Properties of a metric q: a description, and parameters of its Newton steps.
#[derive(Clone, Copy, Debug)]
pub struct Properties {
    /// The name on the command line. The metric's files have the same name, with `_` for `-`.
    pub name: &'static str,
    /// The formula, as text. L are edge lengths, S is the area.
    pub formula: &'static str,
    /// The publication that the metric comes from.
    pub citation: &'static str,
    /// What the metric is good for, and what it does to shapes.
    pub purpose: &'static str,
    /// Whether q grows to infinity as a triangle's area goes to zero.
    pub barrier: bool,
    /// The least value of q, that of an equilateral triangle of the mean area.
    pub ideal: f64,
    /// Whether q does not depend on the size of the triangle.
    pub scale_invariant: bool,
    /// Whether q equals the inverse mean ratio.
    pub is_inverse_mean_ratio: bool,
    /// Whether the objective is quadratic in the position of one vertex, so that one Newton step is exact and its
    /// decrease needs no test.
    pub quadratic: bool,
    /// The eigenvalues of a patch's Hessian are replaced by their absolute values, and raised to at least this share of
    /// the largest.
    pub eigenvalue_floor: f64,
    /// The largest inverse mean ratio that the shape guard lets a step leave, unless the patch had a worse one
    /// before; see [`Plan::shape_guard`](crate::internal::Plan::shape_guard). Infinite if the metric has a barrier.
    pub shape_guard: f64,
    /// The default over-relaxation in runs by this metric alone; see [`Relaxed::omega`](crate::options::Relaxed::omega).
    pub omega: f64,
    /// Whether sweeps by this metric alone can be corrected from coarser levels; see
    /// [`Method::Multilevel`](crate::Method::Multilevel).
    pub is_corrected: bool,
    /// The text of the metric's WGSL file.
    pub wgsl: &'static str,
}
