//! Triangles in place of quadrilaterals, for data that are linear in triangles.

/// Cuts each quadrilateral in two triangles along its shorter diagonal, by the vertices at `points`. The halves follow each other,
/// with the winding of their quadrilateral, and the diagonal leads from the last to the first vertex of a triangle.
///
/// # Panics
/// Panics if a quadrilateral has a vertex that does not exist.
pub fn halves_of_quadrilaterals(
    points: &[[f64; 2]],
    quadrilaterals: impl IntoIterator<Item = [u32; 4]>,
) -> Vec<[u32; 3]> {
    let length = |a: u32, b: u32| {
        let [[ax, ay], [bx, by]] = [a, b].map(|v| points[v as usize]);
        (ax - bx).hypot(ay - by)
    };
    let halves = |[a, b, c, d]: [u32; 4]| match length(a, c) <= length(b, d) {
        true => [[a, b, c], [c, d, a]],
        false => [[b, c, d], [d, a, b]],
    };
    quadrilaterals.into_iter().flat_map(halves).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shorter_diagonal_cuts_a_quadrilateral() {
        let points = [[0.0, 0.0], [2.0, -1.0], [2.0, 1.0], [0.0, 2.0]];
        let halves = |corners| halves_of_quadrilaterals(&points, [corners]);
        assert_eq!(halves([0, 1, 2, 3]), [[0, 1, 2], [2, 3, 0]]);
        assert_eq!(halves([1, 2, 3, 0]), [[2, 3, 0], [0, 1, 2]]);
    }
}
