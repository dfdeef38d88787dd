//! Exact predicates for inverted and flat triangles, on coordinates as given.

use robust::Coord;

use crate::error::{BadTriangle, MeshError};
use crate::parallel::map_ranges;

/// Twice the signed area of a triangle. The sign is exact (Shewchuk's adaptive predicate), the value rounded. NaN or
/// infinite if a coordinate is.
pub(crate) fn orientation(points: &[[f64; 2]], corners: &[u32; 3]) -> f64 {
    let [p, q, r] = corners.map(|v| {
        let [x, y] = points[v as usize];
        Coord { x, y }
    });
    robust::orient2d(p, q, r)
}

/// Whether a triangle is counter-clockwise. False if a coordinate is NaN or infinite.
pub(crate) fn is_positive(points: &[[f64; 2]], corners: &[u32; 3]) -> bool {
    let orientation = orientation(points, corners);
    orientation > 0.0 && orientation < f64::INFINITY
}

/// The indices of the `triangles` that are not counter-clockwise at `points`: those that are inverted or flat, or have
/// a coordinate that is not a finite number. In ascending order.
///
/// # Errors
/// [`MeshError::IndexOutOfRange`] if a triangle names a vertex that `points` does not have,
/// [`MeshError::TooLarge`] if there are more triangles than 32-bit indices can number.
pub fn infeasible(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Result<Vec<u32>, MeshError> {
    let vertices = points.len();
    if triangles.len() >= u32::MAX as usize {
        return Err(MeshError::TooLarge { vertices, triangles: triangles.len() });
    }
    let missing = |&v: &u32| v as usize >= vertices;
    let bad = triangles.iter().position(|t| t.iter().any(missing));
    if let Some(t) = bad
        && let Some(&vertex) = triangles[t].iter().find(|v| missing(v))
    {
        return Err(MeshError::IndexOutOfRange { triangle: Some(t), vertex, vertices });
    }
    Ok(not_positive(points, triangles))
}

/// The result of [`infeasible`], for triangles whose vertices `points` is known to have.
pub(crate) fn not_positive(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Vec<u32> {
    let bad = |t: &usize| !is_positive(points, &triangles[*t]);
    let found = map_ranges(triangles.len(), 1 << 12, |range| -> Vec<u32> {
        range.filter(bad).map(|t| t as u32).collect()
    });
    found.concat()
}

/// The triangles that are not counter-clockwise, each with its vertices and whether it is flat.
pub(crate) fn bad_triangles(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Vec<BadTriangle> {
    let describe = |t: u32| {
        let vertices = triangles[t as usize];
        let flat = orientation(points, &vertices) == 0.0;
        BadTriangle { triangle: t as usize, vertices, flat }
    };
    not_positive(points, triangles).into_iter().map(describe).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flip_below_rounding_is_seen() {
        // 0.1 + 0.2 is above 0.3 by a rounding error, which a plain determinant may not see.
        let points = [[0.0, 0.0], [1.0, 1.0], [0.1 + 0.2, 0.3]];
        assert_eq!(infeasible(&points, &[[0, 1, 2]]), Ok(vec![0]));
        assert_eq!(infeasible(&points, &[[1, 0, 2]]), Ok(vec![]));
    }

    #[test]
    fn a_coordinate_that_is_no_finite_number_makes_a_triangle_infeasible() {
        let good = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for place in 0..6 {
                let mut points = good;
                points[place / 2][place % 2] = bad;
                for triangle in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1]] {
                    let found = infeasible(&points, &[triangle]);
                    assert_eq!(found, Ok(vec![0]), "{bad} at {place}, {triangle:?}");
                }
            }
        }
    }

    #[test]
    fn a_triangle_of_a_missing_vertex_is_an_error() {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let error = infeasible(&points, &[[0, 1, 2], [0, 3, 1]]);
        let expected = MeshError::IndexOutOfRange { triangle: Some(1), vertex: 3, vertices: 3 };
        assert_eq!(error, Err(expected));
    }
}
