//! Centers of faces and edges in the plane, from the coordinates of the corners.

/// Returns the mean of the corners; `None` without corners.
pub(super) fn mean(corners: &[[f64; 2]]) -> Option<[f64; 2]> {
    let &first = corners.first()?;
    // Sums differences to the first corner, which loses no digits far from the origin.
    let offset = |axis: usize| corners.iter().map(|corner| corner[axis] - first[axis]).sum::<f64>();
    Some([0, 1].map(|axis| first[axis] + offset(axis) / corners.len() as f64))
}

/// Returns the center of mass of a polygon; `None` for zero area.
pub(super) fn centroid(corners: &[[f64; 2]]) -> Option<[f64; 2]> {
    let &[first, ref others @ ..] = corners else { return None };
    let (mut area, mut moment) = (0.0, [0.0; 2]);
    for pair in others.windows(2) {
        let [b, c] = [0, 1].map(|k| [pair[k][0] - first[0], pair[k][1] - first[1]]);
        let doubled = b[0] * c[1] - b[1] * c[0];
        area += doubled;
        moment = [0, 1].map(|axis| moment[axis] + doubled * (b[axis] + c[axis]) / 3.0);
    }
    (area != 0.0).then(|| [0, 1].map(|axis| first[axis] + moment[axis] / area))
}

/// Returns the circumcenter of a triangle; `None` for other polygons and for zero area.
pub(super) fn circumcenter(corners: &[[f64; 2]]) -> Option<[f64; 2]> {
    let &[a, b, c] = corners else { return None };
    let [b, c] = [b, c].map(|corner| [corner[0] - a[0], corner[1] - a[1]]);
    let doubled = 2.0 * (b[0] * c[1] - b[1] * c[0]);
    let [bb, cc] = [b, c].map(|[x, y]| x * x + y * y);
    let offset = [(c[1] * bb - b[1] * cc) / doubled, (b[0] * cc - c[0] * bb) / doubled];
    (doubled != 0.0).then(|| [a[0] + offset[0], a[1] + offset[1]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centers_of_triangles_and_quadrilaterals() {
        let triangle = [[1e6, 0.0], [1e6 + 4.0, 0.0], [1e6, 3.0]];
        assert_eq!(mean(&triangle), Some([1e6 + 4.0 / 3.0, 1.0]));
        assert_eq!(circumcenter(&triangle), Some([1e6 + 2.0, 1.5]));
        let close = |a: [f64; 2], b: [f64; 2]| (0..2).all(|k| (a[k] - b[k]).abs() < 1e-9);
        assert!(close(centroid(&triangle).unwrap(), mean(&triangle).unwrap()));
        let trapezoid = [[0.0, 0.0], [6.0, 0.0], [3.0, 3.0], [0.0, 3.0]];
        assert!(close(centroid(&trapezoid).unwrap(), [7.0 / 3.0, 4.0 / 3.0]));
        assert_eq!(mean(&trapezoid), Some([2.25, 1.5]));
        assert_eq!(circumcenter(&trapezoid), None);
        assert_eq!(circumcenter(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]), None);
        assert_eq!((mean(&[]), centroid(&[[1.0, 2.0]])), (None, None));
    }
}
