//! What a metric's row says.

/// Constants of a metric: what is known about it, and how its Newton step is safeguarded.
#[derive(Clone, Copy, Debug)]
pub struct Properties {
    /// The name on the command line, and with `_` for `-` that of the metric's files.
    pub name: &'static str,
    /// The formula, for people.
    pub formula: &'static str,
    /// Where the metric comes from.
    pub citation: &'static str,
    /// What it is good for and what it does to shapes.
    pub purpose: &'static str,
    /// Whether q grows to infinity as a triangle's area goes to zero.
    pub barrier: bool,
    /// q of an equilateral triangle of the mean area, the least value.
    pub ideal: f64,
    /// Whether q is the same for a similar triangle of another size.
    pub scale_invariant: bool,
    /// Whether q is the inverse mean ratio, by whatever formula.
    pub is_inverse_mean_ratio: bool,
    /// Whether the objective is quadratic in one vertex, so that one Newton step is exact and its
    /// decrease needs no test.
    pub quadratic: bool,
    /// Eigenvalues of the patch Hessian are raised to this share of the largest.
    pub eigenvalue_floor: f64,
    /// The largest inverse mean ratio that the shape guard lets a step leave, unless the patch had a worse one
    /// before; see [`Plan::shape_guard`](crate::internal::Plan::shape_guard). Infinite where the barrier does that work.
    pub shape_guard: f64,
    /// The over-relaxation that suits it.
    pub omega: f64,
    /// The graph Laplacian that stands in for the objective's Hessian in a coarse correction, if one does.
    pub stiffness: Option<Stiffness>,
    /// The WGSL file's text.
    pub wgsl: &'static str,
}

/// The weight of an edge in the graph Laplacian that comes near the Hessian of Σ q² on a good mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stiffness {
    /// This over the mean doubled area of the triangles around.
    BySize(f64),
    /// This over the mean doubled area of all triangles.
    Uniform(f64),
}

pub(super) const SQRT_3: f64 = 1.732_050_807_568_877_2;
