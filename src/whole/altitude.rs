//! The least altitude of a mesh, which runs may keep, and the last check of altitudes in coordinates as they are written.

use std::cmp::Ordering;

use glam::DVec2;

use crate::layout::Problem;
use crate::measure::altitude;
use crate::metric::{Corner, Ideal};
use crate::patch::is_kept;
use crate::topology::Topology;

/// Returns the smallest altitude of the given triangles.
fn least(triangles: &[[u32; 3]], at: impl Fn(u32) -> DVec2) -> f64 {
    triangles.iter().map(|t| altitude(t.map(&at))).fold(f64::INFINITY, f64::min)
}

/// Returns the smallest normalized altitude of the triangles in the coordinates of the mesh, with vertices at the
/// problem's positions.
pub(crate) fn least_of(problem: &Problem) -> f64 {
    let (coordinates, positions) = (problem.coordinates(), problem.positions());
    least(problem.corners().all(), |v| coordinates.at(positions[v as usize]))
}

/// Undoes moves until no triangle for which `is_bad` is true has a moved vertex. Returns every vertex whose move was
/// undone.
fn bring_back(
    triangles: &[[u32; 3]],
    before: &[DVec2],
    points: &mut [DVec2],
    is_bad: impl Fn(&[u32; 3], &[DVec2]) -> bool,
) -> Vec<u32> {
    let mut returned = Vec::new();
    loop {
        let is_now_bad = |t: &&[u32; 3]| is_bad(t, points);
        let mut low: Vec<u32> = triangles.iter().filter(is_now_bad).flatten().copied().collect();
        low.sort_unstable();
        low.dedup();
        low.retain(|&v| points[v as usize] != before[v as usize]);
        if low.is_empty() {
            returned.sort_unstable();
            returned.dedup();
            return returned;
        }
        low.iter().for_each(|&v| points[v as usize] = before[v as usize]);
        returned.extend(low);
    }
}

/// Moves vertices of a result back until no altitude is below the smallest altitude of the given mesh, for points as
/// they are written. If a vertex goes back, so do the vertices of each triangle whose inverse mean ratio is above
/// `guard` and larger than before. Returns the number of vertices moved back.
pub(crate) fn restore(
    topology: &Topology<'_>,
    before: &[[f64; 2]],
    points: &mut [[f64; 2]],
    guard: f64,
) -> usize {
    let vectors = |points: &[[f64; 2]]| points.iter().map(|&p| p.into()).collect::<Vec<DVec2>>();
    let (old, mut new) = (vectors(before), vectors(points));
    let triangles = topology.corners();
    let least_altitude = least(triangles, |v| old[v as usize]);
    // An altitude of NaN counts as below the least altitude.
    let is_low = |t: &[u32; 3], at: &[DVec2]| {
        let altitude = altitude(t.map(|v| at[v as usize]));
        altitude.partial_cmp(&least_altitude).is_none_or(|order| order == Ordering::Less)
    };
    let mut returned = bring_back(triangles, &old, &mut new, is_low);
    if !returned.is_empty() && guard.is_finite() {
        let corner = |t: &[u32; 3], at: &[DVec2]| {
            let [p, q, r] = t.map(|v| at[v as usize]);
            Corner { a: (q - p).into(), b: (r - p).into(), ideal: Ideal::of_area(1.0) }
        };
        // Sweeps keep the guard with all vertices moved, so vertices that have gone back may break it.
        let is_bad = |t: &[u32; 3], at: &[DVec2]| {
            is_low(t, at) || !is_kept(&corner(t, &old), &corner(t, at), guard)
        };
        returned.extend(bring_back(triangles, &old, &mut new, is_bad));
        returned.sort_unstable();
        returned.dedup();
    }
    for &v in &returned {
        points[v as usize] = before[v as usize];
    }
    returned.len()
}
