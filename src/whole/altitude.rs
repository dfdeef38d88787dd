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

/// Undoes moves until no triangle for whose index `is_bad` is true has a moved vertex. Returns every vertex whose move was
/// undone.
fn bring_back(
    triangles: &[[u32; 3]],
    before: &[DVec2],
    points: &mut [DVec2],
    is_bad: impl Fn(usize, &[DVec2]) -> bool,
) -> Vec<u32> {
    let mut returned = Vec::new();
    loop {
        let now_bad = (0..triangles.len()).filter(|&t| is_bad(t, points));
        let mut low: Vec<u32> = now_bad.flat_map(|t| triangles[t]).collect();
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

/// Limits of a result in coordinates as they are written.
#[derive(Clone, Copy)]
pub(crate) struct Limits {
    /// Whether no altitude may be below the smallest altitude of the given mesh.
    pub(crate) keeps_altitude: bool,
    /// Largest inverse mean ratio of a triangle that has become worse; infinite for no limit.
    pub(crate) guard: f64,
    /// Whether the guard holds for all triangles. Otherwise the guard holds if a vertex goes back.
    pub(crate) guards_all: bool,
}

impl Limits {
    /// The limit of altitudes alone.
    pub(crate) const ALTITUDE: Self =
        Self { keeps_altitude: true, guard: f64::INFINITY, guards_all: false };
}

/// Moves vertices of a result back until no triangle breaks the limits, for points as they are written. Returns the number
/// of vertices moved back.
pub(crate) fn restore(
    topology: &Topology<'_>,
    before: &[[f64; 2]],
    points: &mut [[f64; 2]],
    limits: Limits,
) -> usize {
    let Limits { keeps_altitude, guard, guards_all } = limits;
    let vectors = |points: &[[f64; 2]]| points.iter().map(|&p| p.into()).collect::<Vec<DVec2>>();
    let (old, mut new) = (vectors(before), vectors(points));
    let corners = topology.corners();
    let least_altitude = least(corners, |v| old[v as usize]);
    // An altitude of NaN counts as below the least altitude.
    let is_low = |t: usize, at: &[DVec2]| {
        let altitude = altitude(corners[t].map(|v| at[v as usize]));
        keeps_altitude
            && altitude.partial_cmp(&least_altitude).is_none_or(|order| order == Ordering::Less)
    };
    let mut returned = bring_back(corners, &old, &mut new, is_low);
    if (guards_all || !returned.is_empty()) && guard.is_finite() {
        let triangles = topology.triangles().len();
        let corner = |t: usize, at: &[DVec2]| {
            let [p, q, r] = corners[t].map(|v| at[v as usize]);
            let corner =
                Corner { a: (q - p).into(), b: (r - p).into(), ideal: Ideal::of_area(1.0) };
            if t < triangles { corner } else { corner.of_right_angle() }
        };
        // Sweeps keep the guard with all vertices moved, so vertices that have gone back may break it.
        let is_bad = |t: usize, at: &[DVec2]| {
            is_low(t, at) || !is_kept(&corner(t, &old), &corner(t, at), guard)
        };
        returned.extend(bring_back(corners, &old, &mut new, is_bad));
        returned.sort_unstable();
        returned.dedup();
    }
    for &v in &returned {
        points[v as usize] = before[v as usize];
    }
    returned.len()
}
