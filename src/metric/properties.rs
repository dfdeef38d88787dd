//! The properties of a metric.

/// Properties of a metric q: a description, and parameters of its Newton steps.
#[derive(Clone, Copy, Debug)]
pub struct Properties {
    /// Name on the command line. The files of the metric have this name too, with `_` for `-`.
    pub name: &'static str,
    /// Formula as text. L are edge lengths, S is the area.
    pub formula: &'static str,
    /// Publication that defines the metric.
    pub citation: &'static str,
    /// Purpose of the metric, and its effect on shapes, as text.
    pub purpose: &'static str,
    /// Whether q grows to infinity as the area of a triangle goes to zero.
    pub barrier: bool,
    /// Value of q of an equilateral triangle of mean area.
    pub ideal: f64,
    /// Least value of q of a single triangle. The value of RMS is less than `ideal`: q falls with the size of the
    /// triangle, while small triangles leave others larger, and the mean of q² of a mesh stays above ideal².
    pub least: f64,
    /// Whether q is independent of the size of a triangle.
    pub scale_invariant: bool,
    /// Whether q² has a term of size that [`Ideal::size_weight`](crate::metric::Ideal::size_weight) multiplies.
    pub has_size_weight: bool,
    /// Whether q equals the inverse mean ratio.
    pub is_inverse_mean_ratio: bool,
    /// Whether the objective is quadratic in the position of one vertex. A single Newton step is then exact, and its
    /// decrease needs no test.
    pub quadratic: bool,
    /// Eigenvalues of a patch's Hessian are replaced by their absolute values, and raised to at least this share of the
    /// larger one.
    pub eigenvalue_floor: f64,
    /// Largest inverse mean ratio that the shape guard lets a step leave, unless the patch had a larger ratio before;
    /// see [`Plan::shape_guard`](crate::internal::Plan::shape_guard). Infinite if the metric has a barrier.
    pub shape_guard: f64,
    /// Default over-relaxation in runs by this metric alone; see [`Relaxed::omega`](crate::options::Relaxed::omega).
    pub omega: f64,
    /// Whether sweeps by this metric alone can be corrected from coarser levels; see
    /// [`Method::Multilevel`](crate::Method::Multilevel).
    pub is_corrected: bool,
    /// Text of the WGSL file of the metric.
    pub wgsl: &'static str,
}
