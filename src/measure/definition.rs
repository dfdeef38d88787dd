//! The description of a measure.

/// Direction of a measure: whether large or small values are better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// Large values are better: the worst element has the least value.
    Higher,
    /// Small values are better: the worst element has the largest value.
    Lower,
}

/// Description of a measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Definition {
    /// Name on the command line.
    pub name: &'static str,
    /// Formula for triangles as text. L are edge lengths, S is the area, r the inradius and R the circumradius.
    pub formula: &'static str,
    /// Unit written after a value: ° for angles, empty for ratios.
    pub unit: &'static str,
    /// Least and largest value of a triangle, inverted triangles included.
    pub range: [f64; 2],
    /// Value of the best triangle.
    pub ideal: f64,
    /// The description for quadrilaterals; `None` if quadrilaterals lack the measure.
    pub quadrilateral: Option<QuadrilateralDefinition>,
    /// Whether large or small values are better.
    pub better: Better,
    /// Publication that defines the measure.
    pub source: &'static str,
}

/// Description of a measure for quadrilaterals.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct QuadrilateralDefinition {
    /// Formula as text. L and L' are the lengths of the two sides at a vertex, α is twice the signed area of the corner triangle,
    /// D are the lengths of the diagonals, and S is the area.
    pub formula: &'static str,
    /// Least and largest value of a quadrilateral, those that are inverted or not convex included.
    pub range: [f64; 2],
    /// Value of the best quadrilateral, a square.
    pub ideal: f64,
}
