//! Centers of faces as Delft3D FM and MeshKernel compute them, from the coordinates of the corners.
//!
//! In degrees, MeshKernel multiplies a difference of longitudes by the cosine of the mean of the two latitudes, so
//! differences are local lengths. The formulas are those of MeshKernel 8 (Deltares), `FaceAreaAndCenterOfMass` and
//! `ComputeFaceCircumenter`.

use crate::mesh_file::plane_centers::{circumcenter, mean};

/// Returns the circumcenter of a triangle. Instead of a circumcenter outside of the triangle, returns the point at which
/// the line from the mean of the corners to the circumcenter leaves the triangle.
pub(super) fn inner_circumcenter(corners: &[[f64; 2]]) -> Option<[f64; 2]> {
    inside(corners, circumcenter(corners)?, |[a, b], [c, d]| [c - a, d - b])
}

/// Returns the center of [`inner_circumcenter`] for corners in degrees.
pub(super) fn inner_local_circumcenter(corners: &[[f64; 2]]) -> Option<[f64; 2]> {
    let &[a, b, c] = corners else { return None };
    let [x, y] = circumcenter(&[[0.0; 2], local(a, b), local(a, c)])?;
    let shortening = mean(corners)?[1].to_radians().cos();
    inside(corners, [a[0] + x / shortening, a[1] + y], local)
}

/// Returns the center of mass of a polygon in degrees; `None` for zero area.
pub(super) fn local_centroid(corners: &[[f64; 2]]) -> Option<[f64; 2]> {
    if corners.len() < 3 {
        return None;
    }
    let origin = [0, 1].map(|axis| corners.iter().fold(f64::MAX, |least, at| least.min(at[axis])));
    let (mut area, mut moment) = (0.0, [0.0; 2]);
    for (&from, &to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let ([a, b], [c, d]) = (local(origin, from), local(origin, to));
        let middle = [0.5 * (a + c), 0.5 * (b + d)];
        let doubled = cross(middle, local(from, to));
        area += 0.5 * doubled;
        moment = [0, 1].map(|axis| moment[axis] + doubled * middle[axis]);
    }
    let [x, y] = moment.map(|moment| moment / (3.0 * area));
    let shortening = (y + origin[1]).to_radians().cos();
    (area != 0.0).then_some([origin[0] + x / shortening, origin[1] + y])
}

/// Returns the local difference from one point in degrees to another, in degrees of latitude.
fn local([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [(c - a) * (0.5 * (b + d)).to_radians().cos(), d - b]
}

fn cross([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    a * d - b * c
}

/// Returns `center`. Instead of a center outside of the corners, returns the point at which the line from the mean of the
/// corners to `center` meets an edge. `difference` returns the local difference from one point to another.
fn inside(
    corners: &[[f64; 2]],
    center: [f64; 2],
    difference: impl Fn([f64; 2], [f64; 2]) -> [f64; 2],
) -> Option<[f64; 2]> {
    let start = mean(corners)?;
    let to_center = difference(start, center);
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    // Each point is a share of the line to the center, and a share of an edge.
    let meetings = ends.map(|(&from, &to)| {
        let (edge, to_edge) = (difference(from, to), difference(start, from));
        let area = cross(to_center, edge);
        [cross(to_edge, edge) / area, cross(to_edge, to_center) / area]
    });
    let mut on_edges = meetings.filter(|shares| shares.iter().all(|x| (0.0..=1.0).contains(x)));
    let Some([share, _]) = on_edges.next() else { return Some(center) };
    Some([0, 1].map(|axis| start[axis] + share * (center[axis] - start[axis])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn assert_close(a: Option<[f64; 2]>, b: [f64; 2]) {
        let is_close = a.is_some_and(|a| (0..2).all(|k| (a[k] - b[k]).abs() < 1e-12));
        assert!(is_close, "{a:?} {b:?}");
    }

    #[test]
    fn inner_circumcenters_stay_in_the_triangle() {
        let acute = [[0.0, 0.0], [4.0, 0.0], [2.0, 3.0]];
        assert_close(inner_circumcenter(&acute), circumcenter(&acute).unwrap());
        // The circumcenter is at (2, -1.5), beyond the long edge.
        let obtuse = [[0.0, 0.0], [4.0, 0.0], [2.0, 1.0]];
        assert_close(circumcenter(&obtuse), [2.0, -1.5]);
        assert_close(inner_circumcenter(&obtuse), [2.0, 0.0]);
    }

    /// MeshKernel 8.3 computed the expected numbers by `mesh2d_get` and `mesh2d_get_property`.
    #[test]
    fn centers_in_degrees_are_those_of_meshkernel() {
        let acute = [[3.0, 52.0], [3.1, 52.0], [3.04, 52.05]];
        let obtuse = [[3.0, 52.0], [3.1, 52.0], [3.04, 52.02]];
        assert_close(local_centroid(&acute), [3.0466765996018697, 52.016666666666666]);
        assert_close(inner_local_circumcenter(&acute), [3.0500186250468295, 52.01590475841351]);
        assert_close(local_centroid(&obtuse), [3.046670638783645, 52.00666666666667]);
        assert_close(inner_local_circumcenter(&obtuse), [3.047814268693251, 52.0]);
        assert_eq!(local_centroid(&acute[..2]), None);
        assert_eq!(local_centroid(&[[1.0, 2.0], [2.0, 2.0], [3.0, 2.0]]), None);
    }
}
