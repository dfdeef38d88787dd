//! Counts how many times the triangles around a vertex wind around it.
//!
//! Triangles may all be counter-clockwise and yet overlap: five of them can wind twice around their common vertex, as
//! in a pentagram. Counting needs only comparisons of coordinates, so the number of turns is exact.

use crate::parallel::map_parts;
use crate::topology::corners::Corners;
use crate::topology::predicates::{is_positive, is_surely_positive};

/// Returns whether `p` has a greater y coordinate than `q`, or the same y and a greater x.
#[inline(always)]
fn is_above(p: [f64; 2], q: [f64; 2]) -> bool {
    (p[1] > q[1]) | ((p[1] == q[1]) & (p[0] > q[0]))
}

/// Returns for each corner of a counter-clockwise triangle whether the direction of the x axis, starting at the corner,
/// leads into the triangle or along the second of the two edges at the corner. At most one corner has this property.
/// The turns around a vertex are as many as the triangles whose corner at the vertex has this property.
#[inline(always)]
fn ahead(points: &[[f64; 2]], corners: &[u32; 3]) -> [bool; 3] {
    let [p, q, r] = corners.map(|v| points[v as usize]);
    // At a corner with this property, the next corner is not above it, and the third corner is.
    let falls = [!is_above(q, p), !is_above(r, q), !is_above(p, r)];
    [falls[2] & falls[0], falls[0] & falls[1], falls[1] & falls[2]]
}

/// Returns whether every corner is counter-clockwise and the elements of every free vertex wind once around it.
/// Tests both in a single pass, as nearly all meshes are feasible.
pub(crate) fn is_feasible(points: &[[f64; 2]], corners: &Corners<'_>, free: &[bool]) -> bool {
    let count = |_, chunk: &[[u32; 3]]| -> Option<usize> {
        let (mut sure, mut turns) = (true, 0);
        for t in chunk {
            sure &= is_surely_positive(points, t);
            turns += turns_at_free(points, t, free);
        }
        (sure || chunk.iter().all(|t| is_positive(points, t))).then_some(turns)
    };
    let of_triangles: Option<usize> =
        map_parts(corners.triangles().chunks(1 << 10), count).into_iter().sum();
    let count = |_, chunk: &[[u32; 3]]| -> Option<usize> {
        let are_positive = chunk.iter().all(|t| is_positive(points, t));
        are_positive.then(|| chunk.iter().filter(|t| turns_at_own(points, t, free)).count())
    };
    let of_others: Option<usize> =
        map_parts(corners.of_quadrilaterals().chunks(1 << 10), count).into_iter().sum();
    matches!((of_triangles, of_others), (Some(a), Some(b)) if a + b == count_of(free))
}

/// Returns the first free vertex around which elements wind more than once, and the number of turns. `None` if there
/// is no such vertex. All corners must be counter-clockwise.
pub(crate) fn overlapping_star(
    points: &[[f64; 2]],
    corners: &Corners<'_>,
    free: &[bool],
) -> Option<(u32, u32)> {
    let count = |_, chunk: &[[u32; 3]]| -> usize {
        chunk.iter().map(|t| turns_at_free(points, t, free)).sum()
    };
    let of_triangles: usize =
        map_parts(corners.triangles().chunks(1 << 12), count).into_iter().sum();
    let count = |_, chunk: &[[u32; 3]]| -> usize {
        chunk.iter().filter(|t| turns_at_own(points, t, free)).count()
    };
    let of_others: usize =
        map_parts(corners.of_quadrilaterals().chunks(1 << 12), count).into_iter().sum();
    // Each star winds at least once, so equal sums mean that every star winds exactly once.
    if of_triangles + of_others == count_of(free) {
        return None;
    }
    let mut turns = vec![0; free.len()];
    for t in corners.of_quadrilaterals().iter().filter(|t| turns_at_own(points, t, free)) {
        turns[t[0] as usize] += 1;
    }
    for t in corners.triangles() {
        let counts = ahead(points, t).into_iter().zip(t).find(|(ahead, _)| *ahead);
        if let Some((_, &v)) = counts
            && free[v as usize]
        {
            turns[v as usize] += 1;
        }
    }
    let vertex = turns.iter().position(|&turns| turns > 1)?;
    Some((vertex as u32, turns[vertex]))
}

/// Returns 1 if the corner of a triangle that counts as a turn (see [`ahead`]) is a free vertex, else 0. Computed
/// without branches, as a processor would mispredict every second branch.
#[inline(always)]
fn turns_at_free(points: &[[f64; 2]], corners: &[u32; 3], free: &[bool]) -> usize {
    let is_ahead = ahead(points, corners);
    let counts = |corner: usize| is_ahead[corner] & free[corners[corner] as usize];
    usize::from(counts(0) | counts(1) | counts(2))
}

/// Returns whether the first vertex of a corner of a quadrilateral is free, and the corner counts as a turn around it; see
/// [`ahead`].
fn turns_at_own(points: &[[f64; 2]], corner: &[u32; 3], free: &[bool]) -> bool {
    free[corner[0] as usize] && ahead(points, corner)[0]
}

/// Returns the number of free vertices.
fn count_of(free: &[bool]) -> usize {
    free.iter().filter(|&&free| free).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Returns a fan of `around` triangles that winds `turns` times, rotated by `angle` in radians.
    fn fan(around: u32, turns: u32, angle: f64) -> (Vec<[f64; 2]>, Vec<[u32; 3]>) {
        let on_circle = |k: u32| {
            let (y, x) = (angle + TAU * f64::from(k * turns) / f64::from(around)).sin_cos();
            [x, y]
        };
        let points = (0..around).map(on_circle).chain([[0.01, 0.02]]).collect();
        (points, (0..around).map(|k| [k, (k + 1) % around, around]).collect())
    }

    #[test]
    fn turns_of_a_star_around_its_vertex_are_counted() {
        for (around, turns) in [(3, 1), (4, 1), (12, 1), (5, 2), (7, 2), (7, 3), (40, 19)] {
            for angle in [0.0, 0.3, 1.0, 2.0, 4.0] {
                let (points, triangles) = fan(around, turns, angle);
                let mut free = vec![false; points.len()];
                free[around as usize] = true;
                let found = overlapping_star(&points, &Corners::of_lists(triangles, &[]), &free);
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
        assert_eq!(
            overlapping_star(&points, &Corners::of_lists(triangles.to_vec(), &[]), &free),
            None
        );
    }
}
