//! The stage that bounds altitudes: no altitude falls below the smallest altitude of the given mesh. Vertices of
//! triangles below the bound go back and are held, while other vertices move on.

use std::cmp::Ordering;

use glam::DVec2;

use crate::error::MeshError;
use crate::layout::{MeshCoordinates, Problem};
use crate::measure::altitude;
use crate::metric::{Corner, Ideal};
use crate::patch::is_kept;
use crate::run::Stop;
use crate::run::records::{Reader, Writer};
use crate::topology::Topology;
use crate::whole::host::Host;
use crate::whole::stage::{Judgment, Period, Stage, Worked};

/// Number of sweeps in a period, while the stage still moves vertices back.
const SWEEPS: u32 = 2;
/// Largest number of periods, after which the run ends.
const PERIODS: u32 = 60;
/// Number of halvings of the moves of vertices, before the moves are undone.
const MAX_HALVINGS: u32 = 3;

/// Returns the smallest altitude of the given triangles.
fn least(triangles: &[[u32; 3]], at: impl Fn(u32) -> DVec2) -> f64 {
    triangles.iter().map(|t| altitude(t.map(&at))).fold(f64::INFINITY, f64::min)
}

/// Returns the smallest normalized altitude of the triangles in the coordinates of the mesh, with vertices at the
/// problem's positions.
pub(crate) fn least_of(problem: &Problem) -> f64 {
    least_at(problem, problem.positions())
}

fn least_at(problem: &Problem, positions: &[DVec2]) -> f64 {
    let coordinates = problem.coordinates();
    least(problem.triangles(), |v| coordinates.at(positions[v as usize]))
}

/// The bounds that triangles keep after a move. `corner` returns a triangle with vertices at given positions.
struct Bounds<F> {
    /// Smallest altitude in the coordinates of the mesh.
    floor: f64,
    coordinates: MeshCoordinates,
    /// Largest inverse mean ratio of a triangle that becomes worse; infinite for no guard.
    guard: f64,
    corner: F,
}

impl<F: Fn(&[u32; 3], &[DVec2]) -> Corner<f64>> Bounds<F> {
    /// Moves the vertices of triangles below the floor back toward `before`. Sweeps keep the guard with all vertices
    /// moved, so if vertices have gone back, the vertices of triangles that break the guard follow. Returns every vertex
    /// whose move was shortened, ascending. See [`bring_back`] for `halved`.
    fn restore(
        &self,
        triangles: &[[u32; 3]],
        before: &[DVec2],
        points: &mut [DVec2],
        halved: u32,
    ) -> Vec<u32> {
        // An altitude of NaN counts as below the floor.
        let is_low = |t: &[u32; 3], at: &[DVec2]| {
            let altitude = altitude(t.map(|v| self.coordinates.at(at[v as usize])));
            altitude.partial_cmp(&self.floor).is_none_or(|order| order == Ordering::Less)
        };
        let mut returned = bring_back(triangles, before, points, is_low, halved);
        if !returned.is_empty() && self.guard.is_finite() {
            let corner = &self.corner;
            let is_bad = |t: &[u32; 3], at: &[DVec2]| {
                is_low(t, at) || !is_kept(&corner(t, before), &corner(t, at), self.guard)
            };
            returned.extend(bring_back(triangles, before, points, is_bad, halved));
            returned.sort_unstable();
            returned.dedup();
        }
        returned
    }
}

/// Repeats passes until no triangle for which `is_bad` is true has a moved vertex. The first `halved` passes halve the
/// moves of the vertices of these triangles; later passes undo the moves. Returns every vertex whose move was shortened.
fn bring_back(
    triangles: &[[u32; 3]],
    before: &[DVec2],
    points: &mut [DVec2],
    is_bad: impl Fn(&[u32; 3], &[DVec2]) -> bool,
    mut halved: u32,
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
        for &v in &low {
            let (point, before) = (&mut points[v as usize], before[v as usize]);
            *point = if halved > 0 { before + (*point - before) * 0.5 } else { before };
        }
        halved = halved.saturating_sub(1);
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
    let triangles = topology.triangles();
    let corner = |t: &[u32; 3], at: &[DVec2]| {
        let [p, q, r] = t.map(|v| at[v as usize]);
        Corner { a: (q - p).into(), b: (r - p).into(), ideal: Ideal::of_area(1.0) }
    };
    let (floor, coordinates) =
        (least(triangles, |v| old[v as usize]), MeshCoordinates::OF_POSITIONS);
    let bounds = Bounds { floor, coordinates, guard, corner };
    let returned = bounds.restore(triangles, &old, &mut new, 0);
    for &v in &returned {
        points[v as usize] = before[v as usize];
    }
    returned.len()
}

/// The stage that bounds altitudes by the smallest altitude of the start.
pub(crate) struct AltitudeStage<'s> {
    problem: &'s Problem,
    /// Smallest altitude at the start of the run, normalized.
    least: f64,
    /// Whether no further vertex was held after the last period.
    is_clean: bool,
    /// Whether the last period began without a limit of sweeps, because the period before held no further vertex.
    was_clean: bool,
    /// Number of completed periods.
    count: u32,
}

impl<'s> AltitudeStage<'s> {
    /// Creates the stage, with the smallest altitude of the problem's positions as the bound.
    pub(crate) fn new(problem: &'s Problem) -> Self {
        Self { problem, least: least_of(problem), is_clean: false, was_clean: false, count: 0 }
    }
}

impl Stage for AltitudeStage<'_> {
    fn name(&self) -> &'static str {
        "altitude"
    }

    fn period(&self) -> u32 {
        if self.is_clean { u32::MAX } else { SWEEPS }
    }

    /// Moves the vertices of triangles below the bound back, and holds them in all later sweeps.
    fn work(
        &mut self,
        host: &mut Host<'_>,
        _: &dyn Fn(&[DVec2]) -> bool,
    ) -> Result<Worked, MeshError> {
        self.count = self.count.saturating_add(1);
        let guard = host.guard();
        let Host { problem, before, positions, held, .. } = host;
        let corner = |t: &[u32; 3], at: &[DVec2]| problem.corner(t, |v| at[v as usize]);
        let (floor, coordinates) = (self.least, problem.coordinates());
        let bounds = Bounds { floor, coordinates, guard, corner };
        let returned = bounds.restore(problem.triangles(), before, positions, MAX_HALVINGS);
        let mut is_settled = true;
        for v in returned {
            if let Some(held) = held.get_mut(v as usize) {
                is_settled &= std::mem::replace(held, true);
            }
        }
        (self.was_clean, self.is_clean) = (self.is_clean, is_settled);
        Ok(Worked { is_settled, has_moved_free: false })
    }

    fn allows(&self, positions: &[DVec2]) -> bool {
        least_at(self.problem, positions) >= self.least
    }

    fn judge(&mut self, period: &Period) -> Judgment {
        let has_periods_left = self.count < PERIODS;
        let stop = match period.swept {
            _ if period.all_held => Some(Stop::Converged),
            _ if !has_periods_left && !period.is_settled => Some(Stop::Stalled),
            swept if self.was_clean && period.is_settled || !has_periods_left => {
                swept.or(Some(Stop::MaxSweeps))
            }
            _ => period.is_last.then_some(Stop::MaxSweeps),
        };
        Judgment { stop, remaining: period.remaining }
    }

    fn save(&self, out: &mut Writer) {
        out.number(self.is_clean.into());
        out.number(self.was_clean.into());
        out.number(self.count.into());
    }

    fn restore(&mut self, _: &mut Host<'_>, from: &mut Reader<'_>) -> Option<()> {
        (self.is_clean, self.was_clean) = (from.flag()?, from.flag()?);
        self.count = from.count()?;
        Some(())
    }
}
