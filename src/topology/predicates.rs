//! Exact predicates for inverted and flat triangles, on coordinates as given.

use robust::Coord;

use crate::error::MeshError;
use crate::mesh::Element;
use crate::parallel::pace::now;
use crate::parallel::paced;

/// Bound below which the products of a determinant may have lost bits to underflow. About 2^-960, far above the least
/// positive `f64`.
pub(crate) const UNDERFLOW: f64 = 1e-289;

/// Relative rounding error of a determinant. If the determinant of a triangle exceeds this share of the sum of its two
/// products, rounding cannot have changed its sign (Shewchuk, Discrete Comput. Geom. 18, 1997, the bound of ORIENT2D's
/// first stage).
pub(crate) const ROUNDING: f64 = (3.0 + 8.0 * f64::EPSILON) * 0.5 * f64::EPSILON;

/// Returns twice the signed area of a triangle. The sign is exact (Shewchuk's adaptive predicate), the value is
/// rounded, but zero only if the triangle is flat. The result is NaN or infinite if a coordinate is.
///
/// The sign is exact for all coordinates of absolute value up to 1e100, if coordinates other than zero are at least
/// 1e-300 in absolute value.
#[inline]
pub(crate) fn orientation(points: &[[f64; 2]], corners: &[u32; 3]) -> f64 {
    let [p, q, r] = corners.map(|v| points[v as usize]);
    let (left, right) = ((p[0] - r[0]) * (q[1] - r[1]), (p[1] - r[1]) * (q[0] - r[0]));
    let determinant = left - right;
    // The inequality decides nearly all triangles of a mesh without a call.
    let least = ROUNDING * (left.abs() + right.abs()) + UNDERFLOW;
    if determinant.abs() > least { determinant } else { exact_orientation([p, q, r]) }
}

fn exact_orientation(corners: [[f64; 2]; 3]) -> f64 {
    let orientation = orient(corners);
    // The comparison is false if `orientation` is NaN; NaN is then returned.
    if orientation.abs() < UNDERFLOW { tiny_orientation(corners) } else { orientation }
}

fn orient(corners: [[f64; 2]; 3]) -> f64 {
    let [p, q, r] = corners.map(|[x, y]| Coord { x, y });
    robust::orient2d(p, q, r)
}

/// Computes [`orientation`] for triangles so small or flat that products of their coordinates may underflow. Scales
/// each axis by a power of two first, which rounds nothing and keeps the sign.
#[cold]
fn tiny_orientation(corners: [[f64; 2]; 3]) -> f64 {
    let [x, y] = [0, 1].map(|axis| {
        let size = corners.iter().fold(0.0, |size: f64, corner| size.max(corner[axis].abs()));
        up(size)
    });
    let scaled = orient(corners.map(|corner| [scaled(corner[0], x), scaled(corner[1], y)]));
    let value = unscaled(unscaled(scaled, x), y);
    // The unscaled value may underflow to zero although the triangle is not flat.
    if value == 0.0 && scaled != 0.0 { f64::from_bits(1).copysign(scaled) } else { value }
}

/// Returns the largest exponent of a power of two that keeps `size` below 2^480 when multiplied. 0 if `size` is 0.
fn up(size: f64) -> i32 {
    if size == 0.0 {
        return 0;
    }
    // A subnormal number has no exponent bits, and is scaled before they are read.
    let (size, already) = if size < 1e-200 { (size * 600f64.exp2(), 600) } else { (size, 0) };
    479 - (((size.to_bits() >> 52) & 0x7ff) as i32 - 1023 - already)
}

/// Returns `x` times 2 to the power `exponent`. Multiplies twice, as the power itself may overflow.
fn scaled(x: f64, exponent: i32) -> f64 {
    let half = exponent / 2;
    x * f64::from(half).exp2() * f64::from(exponent - half).exp2()
}

fn unscaled(x: f64, exponent: i32) -> f64 {
    scaled(x, -exponent)
}

/// Returns whether a triangle is counter-clockwise by the fast test alone, without a branch, so that loops over
/// triangles are fast. False also for a triangle so flat or small that only [`is_positive`] can decide; a mesh has few
/// of them.
#[inline(always)]
pub(crate) fn is_surely_positive(points: &[[f64; 2]], corners: &[u32; 3]) -> bool {
    let [p, q, r] = corners.map(|v| points[v as usize]);
    let (left, right) = ((p[0] - r[0]) * (q[1] - r[1]), (p[1] - r[1]) * (q[0] - r[0]));
    let determinant = left - right;
    let least = ROUNDING * (left.abs() + right.abs()) + UNDERFLOW;
    (determinant > least) & (determinant < f64::INFINITY)
}

/// Returns whether a triangle is counter-clockwise, by exact arithmetic. False if a coordinate is NaN or infinite.
#[inline]
pub(crate) fn is_positive(points: &[[f64; 2]], corners: &[u32; 3]) -> bool {
    let orientation = orientation(points, corners);
    orientation > 0.0 && orientation < f64::INFINITY
}

/// Returns the indices of the `triangles` that are not counter-clockwise at `points`, in ascending order. These
/// triangles are inverted or flat, or have a coordinate that is infinite or NaN.
///
/// # Errors
/// [`MeshError::IndexOutOfRange`] if a triangle names a vertex that `points` does not have, [`MeshError::TooLarge`] if
/// there are more triangles than 32-bit indices can number.
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
        return Err(MeshError::IndexOutOfRange {
            element: Some(Element::Triangle(t)),
            vertex,
            vertices,
        });
    }
    Ok(now(not_positive(points, triangles)))
}

/// Returns the triangles that [`infeasible`] would return. Panics if `points` lacks a vertex of `triangles`.
pub(crate) async fn not_positive(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Vec<u32> {
    const CHUNK: usize = 1 << 10;
    let found = paced::map_parts(triangles.chunks(CHUNK), |chunk, part| -> Vec<u32> {
        if part.iter().all(|t| is_surely_positive(points, t)) {
            return Vec::new();
        }
        let bad = part.iter().zip(chunk * CHUNK..).filter(|(t, _)| !is_positive(points, t));
        bad.map(|(_, index)| index as u32).collect()
    });
    found.await.concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inversion_smaller_than_rounding_is_found() {
        // 0.1 + 0.2 exceeds 0.3 by a rounding error, which a plain determinant may miss.
        let points = [[0.0, 0.0], [1.0, 1.0], [0.1 + 0.2, 0.3]];
        assert_eq!(infeasible(&points, &[[0, 1, 2]]), Ok(vec![0]));
        assert_eq!(infeasible(&points, &[[1, 0, 2]]), Ok(vec![]));
    }

    /// Tests corners on a fine grid, many of them nearly collinear, with sizes at which products of coordinates
    /// underflow. Compares their orientation with the orientation computed in integers.
    #[test]
    fn signs_are_exact_for_triangles_of_any_size() {
        let mut state = 1_u64;
        let mut random = |bound: i64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 20) as i64 % bound
        };
        for exponent in [-1074, -900, -560, -548, -530, -400, -100, 0, 200] {
            let unit = scaled(1.0, exponent);
            for round in 0..2000 {
                let [a, b] =
                    [0; 2].map(|_| [random(1 << 40) - (1 << 39), random(1 << 40) - (1 << 39)]);
                let c = match round % 3 {
                    0 => [random(1 << 40), random(1 << 40)],
                    1 => [(a[0] + b[0]) / 2 + random(3) - 1, (a[1] + b[1]) / 2],
                    _ => [2 * b[0] - a[0], 2 * b[1] - a[1] + random(3) - 1],
                };
                let wide = [a, b, c].map(|point| point.map(i128::from));
                let [[ax, ay], [bx, by], [cx, cy]] = wide;
                let exact = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
                let points = [a, b, c].map(|point| point.map(|x| x as f64 * unit));
                let found = orientation(&points, &[0, 1, 2]);
                let sign = i32::from(found > 0.0) - i32::from(found < 0.0);
                assert_eq!(sign, exact.signum() as i32, "{points:?}");
            }
        }
    }

    #[test]
    fn signs_are_exact_where_sizes_differ_by_hundreds_of_decades() {
        // The area is 1e-600, with the sign of the last coordinate.
        for (y, sign) in [(1e-300, -1.0), (-1e-300, 1.0), (0.0, 0.0)] {
            let points = [[0.0, 0.0], [1.0, y], [1e-300, 0.0]];
            let found = orientation(&points, &[0, 1, 2]);
            assert_eq!(if found == 0.0 { 0.0 } else { found.signum() }, sign, "{y}");
        }
        let points = [[0.0, 0.0], [1e100, 0.0], [1e100, 5e-324]];
        assert!(is_positive(&points, &[0, 1, 2]) && !is_positive(&points, &[1, 0, 2]));
    }

    #[test]
    fn the_fast_positivity_test_agrees_with_the_exact_one() {
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 - (1 << 23) as f64
        };
        let mut sure = 0;
        for round in 0..20_000 {
            let [a, b] = [0; 2].map(|_| [random(), random()]);
            // In every other triangle, the third corner is on the line through the first two, except for rounding.
            let share = random() / 1e7;
            let middle = [0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis]));
            let points = [a, b, if round % 2 == 0 { middle } else { [random(), random()] }];
            let is_sure = is_surely_positive(&points, &[0, 1, 2]);
            assert!(!is_sure || is_positive(&points, &[0, 1, 2]), "{points:?}");
            sure += usize::from(is_sure);
        }
        assert!((3000..7000).contains(&sure), "{sure}");
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(!is_surely_positive(&[[0.0, 0.0], [bad, 0.0], [0.0, 1.0]], &[0, 1, 2]));
        }
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
        let expected = MeshError::IndexOutOfRange {
            element: Some(Element::Triangle(1)),
            vertex: 3,
            vertices: 3,
        };
        assert_eq!(error, Err(expected));
    }
}
