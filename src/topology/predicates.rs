//! Feasibility by exact predicates: no triangle inverted or flat, on the very values given.

use rayon::prelude::*;
use robust::Coord;

use crate::error::MeshError;

/// Twice the signed area of a triangle, in plain floating point: for sums, not for decisions.
pub(crate) fn doubled_area(points: &[[f64; 2]], corners: &[u32; 3]) -> f64 {
    let [p, q, r] = corners.map(|v| points[v as usize]);
    (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
}

/// A number whose sign is exactly that of the triangle's area (Shewchuk's adaptive predicate).
pub(crate) fn orientation(points: &[[f64; 2]], corners: &[u32; 3]) -> f64 {
    let [p, q, r] = corners.map(|v| {
        let [x, y] = points[v as usize];
        Coord { x, y }
    });
    robust::orient2d(p, q, r)
}

/// The counter-clockwise `triangles` that are inverted or flat, ascending.
pub fn infeasible(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Vec<u32> {
    let bad = |&t: &u32| orientation(points, &triangles[t as usize]) <= 0.0;
    (0..triangles.len() as u32).into_par_iter().filter(bad).collect()
}

/// Fails with [`MeshError::Infeasible`] unless every triangle is counter-clockwise.
pub(crate) fn check(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    let bad = infeasible(points, triangles);
    let Some(&first) = bad.first() else { return Ok(()) };
    let first = first as usize;
    let vertices = triangles[first];
    let flat = orientation(points, &vertices) == 0.0;
    Err(MeshError::Infeasible { count: bad.len(), first, vertices, flat })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flip_below_rounding_is_seen() {
        // 0.1 + 0.2 lies above 0.3 by one rounding; the naive determinant is not to be trusted.
        let points = [[0.0, 0.0], [1.0, 1.0], [0.1 + 0.2, 0.3]];
        assert_eq!(infeasible(&points, &[[0, 1, 2]]), [0]);
        assert!(infeasible(&points, &[[1, 0, 2]]).is_empty());
    }
}
