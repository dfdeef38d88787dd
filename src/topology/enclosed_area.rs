//! The area within the boundary of a mesh, from the boundary alone.

use crate::topology::predicates;

/// The area that boundary edges enclose, as a sum along the boundary. The sum contains no vertex inside the boundary, so
/// vertices that a damaged file puts far away do not hide the area under their rounding errors.
#[derive(Default)]
pub(crate) struct EnclosedArea {
    /// A vertex of the boundary, to which the areas of edges refer. `None` before the first edge.
    origin: Option<u32>,
    doubled: f64,
    /// Sum of the rounding errors of `doubled`.
    lost: f64,
}

impl EnclosedArea {
    /// Adds the triangle of an edge and the origin. The enclosed domain lies to the left of the edge.
    pub(crate) fn add(&mut self, points: &[[f64; 2]], [a, b]: [u32; 2]) {
        let origin = *self.origin.get_or_insert(a);
        let area = predicates::orientation(points, &[origin, a, b]);
        let sum = self.doubled + area;
        // Neumaier's compensated sum.
        self.lost += match self.doubled.abs() >= area.abs() {
            true => (self.doubled - sum) + area,
            false => (area - sum) + self.doubled,
        };
        self.doubled = sum;
    }

    /// Returns twice the area that edges enclose, NaN without an edge.
    pub(crate) fn of_edges(points: &[[f64; 2]], edges: impl IntoIterator<Item = [u32; 2]>) -> f64 {
        let mut area = Self::default();
        edges.into_iter().for_each(|edge| area.add(points, edge));
        area.doubled().unwrap_or(f64::NAN)
    }

    /// Returns twice the enclosed area, `None` without a boundary edge.
    pub(crate) fn doubled(&self) -> Option<f64> {
        self.origin.map(|_| self.doubled + self.lost)
    }
}
