//! How many times the triangles around a vertex wind around it.
//!
//! Triangles may all be counter-clockwise and yet overlap: five of them can wind twice around their common vertex, as in a
//! pentagram. Only comparisons of coordinates are needed to see that, so it is exact.

use crate::parallel::map_parts;
use crate::topology::predicates::is_positive;

/// Whether a point lies above another, or at the same height to the right of it.
#[inline(always)]
fn is_above(p: [f64; 2], q: [f64; 2]) -> bool {
    (p[1] > q[1]) | ((p[1] == q[1]) & (p[0] > q[0]))
}

/// The corner of a counter-clockwise triangle from which the direction of the x axis leads into the triangle or along
/// the second of the two edges there, if there is one. Around a vertex, as many triangles have that corner at the vertex
/// as they wind around it.
#[inline(always)]
fn ahead(points: &[[f64; 2]], corners: &[u32; 3]) -> Option<u32> {
    let [p, q, r] = corners.map(|v| points[v as usize]);
    let (pq, qr, rp) = (is_above(q, p), is_above(r, q), is_above(p, r));
    // From each corner, the next one must not be above it, and the one after next must be.
    match (pq, qr, rp) {
        (false, _, false) => Some(corners[0]),
        (false, false, _) => Some(corners[1]),
        (_, false, false) => Some(corners[2]),
        _ => None,
    }
}

/// Whether every triangle is counter-clockwise and every free vertex has triangles that wind once around it. In one pass,
/// as nearly all meshes pass.
pub(crate) fn is_feasible(points: &[[f64; 2]], triangles: &[[u32; 3]], free: &[bool]) -> bool {
    let count = |_, chunk: &[[u32; 3]]| -> Option<usize> {
        let turn = |t: &[u32; 3]| is_positive(points, t).then(|| turns_at_free(points, t, free));
        chunk.iter().map(turn).sum()
    };
    let turns: Option<usize> = map_parts(triangles.chunks(1 << 12), count).into_iter().sum();
    turns == Some(count_of(free))
}

/// A free vertex around which the triangles wind more than once, and how many times, if there is one. All triangles must
/// be counter-clockwise.
pub(crate) fn overlapping_star(
    points: &[[f64; 2]],
    triangles: &[[u32; 3]],
    free: &[bool],
) -> Option<(u32, u32)> {
    let count = |_, chunk: &[[u32; 3]]| -> usize {
        chunk.iter().map(|t| turns_at_free(points, t, free)).sum()
    };
    let turns: usize = map_parts(triangles.chunks(1 << 12), count).into_iter().sum();
    // Each star winds once at least.
    if turns == count_of(free) {
        return None;
    }
    let mut turns = vec![0; free.len()];
    let at_free = |t: &[u32; 3]| ahead(points, t).filter(|&v| free[v as usize]);
    triangles.iter().filter_map(at_free).for_each(|v| turns[v as usize] += 1);
    let vertex = turns.iter().position(|&turns| turns > 1)?;
    Some((vertex as u32, turns[vertex]))
}

/// 1 if the corner of a triangle that counts for turns is at a free vertex, else 0.
#[inline(always)]
fn turns_at_free(points: &[[f64; 2]], corners: &[u32; 3], free: &[bool]) -> usize {
    usize::from(ahead(points, corners).is_some_and(|v| free[v as usize]))
}

/// Number of free vertices.
fn count_of(free: &[bool]) -> usize {
    free.iter().filter(|&&free| free).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A fan of `around` triangles that winds `turns` times, turned by `angle`.
    fn fan(around: u32, turns: u32, angle: f64) -> (Vec<[f64; 2]>, Vec<[u32; 3]>) {
        let on_circle = |k: u32| {
            let (y, x) = (angle + TAU * f64::from(k * turns) / f64::from(around)).sin_cos();
            [x, y]
        };
        let points = (0..around).map(on_circle).chain([[0.01, 0.02]]).collect();
        (points, (0..around).map(|k| [k, (k + 1) % around, around]).collect())
    }

    #[test]
    fn turns_are_counted() {
        for (around, turns) in [(3, 1), (4, 1), (12, 1), (5, 2), (7, 2), (7, 3), (40, 19)] {
            for angle in [0.0, 0.3, 1.0, 2.0, 4.0] {
                let (points, triangles) = fan(around, turns, angle);
                let mut free = vec![false; points.len()];
                free[around as usize] = true;
                let found = overlapping_star(&points, &triangles, &free);
                let expected = (turns > 1).then_some((around, turns));
                assert_eq!(found, expected, "{around} triangles, {turns} turns, at {angle}");
            }
        }
    }

    #[test]
    fn neighbors_at_the_same_height_count_once() {
        let points = vec![[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [0.0, 0.0]];
        let triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let free = [false, false, false, false, true];
        assert_eq!(overlapping_star(&points, &triangles, &free), None);
    }
}
