//! Runs in which no triangle's altitude falls below the least altitude of the given mesh. Vertices that would violate
//! this go back until they do not, and are then held, while the others continue.

use std::cmp::Ordering;

use glam::DVec2;

use crate::error::SmoothError;
use crate::layout::Problem;
use crate::measure::altitude;
use crate::mesh::Mesh;
use crate::run::{Keeper, Keeping, Observer, Options, Stop};
use crate::topology::Topology;
use crate::whole::attempt::{Attempt, Ended, Round};
use crate::whole::holding::Holding;
use crate::whole::in_rounds::{self, objectives};

/// Number of sweeps in a round, until a round after which no vertex goes back.
const SWEEPS: u32 = 2;
/// The most rounds of sweeps.
const ROUNDS: u32 = 60;
/// Number of times that the way of vertices is halved before they go back completely.
const HALVED: u32 = 3;

/// Returns the least altitude of some triangles.
fn least(triangles: &[[u32; 3]], at: impl Fn(u32) -> DVec2) -> f64 {
    triangles.iter().map(|t| altitude(t.map(&at))).fold(f64::INFINITY, f64::min)
}

/// Returns the least altitude of a triangle with the vertices at the problem's positions, normalized.
pub(crate) fn least_of(problem: &Problem) -> f64 {
    least(problem.triangles(), |v| problem.positions()[v as usize])
}

/// Brings the vertices of triangles whose altitude is below `floor` back toward their old positions: half of the way,
/// `halved` times, and then completely. This is repeated until no triangle is too low that was not so before. Returns
/// the vertices that were brought back.
fn bring_back(
    triangles: &[[u32; 3]],
    before: &[DVec2],
    points: &mut [DVec2],
    floor: f64,
    mut halved: u32,
) -> Vec<u32> {
    let mut returned = Vec::new();
    loop {
        // NaN counts as below the floor.
        let is_low = |t: &&[u32; 3]| {
            let altitude = altitude(t.map(|v| points[v as usize]));
            altitude.partial_cmp(&floor).is_none_or(|order| order == Ordering::Less)
        };
        let mut low: Vec<u32> = triangles.iter().filter(is_low).flatten().copied().collect();
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

/// Sets back vertices so that the least altitude of a mesh is not less than before, for points as they are written.
/// Returns the number of these vertices.
pub(crate) fn restore(
    topology: &Topology<'_>,
    before: &[[f64; 2]],
    points: &mut [[f64; 2]],
) -> usize {
    let vectors = |points: &[[f64; 2]]| points.iter().map(|&p| p.into()).collect::<Vec<DVec2>>();
    let (old, mut new) = (vectors(before), vectors(points));
    let floor = least(topology.triangles(), |v| old[v as usize]);
    let returned = bring_back(topology.triangles(), &old, &mut new, floor, 0);
    for &v in &returned {
        points[v as usize] = before[v as usize];
    }
    returned.len()
}

/// Checks that altitudes can be kept in a run with these options.
pub(crate) fn check(options: &Options, is_continued: bool) -> Result<(), SmoothError> {
    let option = "keep altitude";
    if options.max_move.is_some() {
        let (value, remedy) = ("with a bound on moves".to_owned(), "leave out one of the two");
        return Err(SmoothError::Option { option, value, remedy });
    }
    in_rounds::check(option, options, is_continued)
}

/// The least altitude that a run keeps, and the vertices that are held for it.
pub(crate) struct Floor<'s> {
    problem: &'s Problem,
    holding: Holding<'s>,
    /// The least altitude, normalized.
    pub(crate) least: f64,
}

impl<'s> Floor<'s> {
    /// Takes the least altitude of a triangle with the vertices at the problem's positions.
    pub(crate) fn new(mesh: &'s Mesh, problem: &'s Problem) -> Self {
        Self { problem, holding: Holding::new(mesh, problem), least: least_of(problem) }
    }

    /// Does a round, which moves the vertices from `positions`: sweeps on the engine, after which the vertices of
    /// triangles that have become too low go back, and are held from then on. Returns the end of the round without
    /// positions, and the number of vertices that are held anew. Gains that were undone do not count in its history.
    pub(crate) async fn round<K: Keeper + ?Sized>(
        &mut self,
        attempt: Attempt<'_>,
        round: Round<'_>,
        positions: &mut Vec<DVec2>,
        keeping: &mut Keeping<'_, K>,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<(Ended, usize), SmoothError> {
        let Round { options: part, plan, target } = round;
        let Self { problem, holding, least } = self;
        let (problem, base) = (*problem, plan.scheme.base());
        let smaller = holding.smaller()?;
        let now = smaller.as_ref().unwrap_or(problem);
        let from = holding.renumbered(positions, now);
        let attempt = Attempt { problem: now, ..attempt };
        let mut next = attempt.sweep(part, target, &from, None, keeping, observe).await?;
        let mut to = holding.numbered_back(&std::mem::take(&mut next.positions), now);
        let returned = bring_back(problem.triangles(), positions, &mut to, *least, HALVED);
        *positions = to;
        // The gain of moves that were undone does not count.
        let here = objectives(problem, plan, positions);
        let count = next.history.len() - 1;
        for (k, entry) in next.history.iter_mut().enumerate().skip(1) {
            if k == count || entry.of(base) < here.of(base) {
                *entry = here;
            }
        }
        let free = holding.held.len();
        let mut new = 0;
        for v in returned.into_iter().map(|v| v as usize).filter(|&v| v < free) {
            new += usize::from(!std::mem::replace(&mut holding.held[v], true));
        }
        Ok((next, new))
    }

    /// Whether no altitude is below the least.
    pub(crate) fn holds_at(&self, positions: &[DVec2]) -> bool {
        least(self.problem.triangles(), |v| positions[v as usize]) >= self.least
    }
}

/// Sweeps from the positions of the problem until the run ends, with no altitude below the least one at the start.
pub(crate) async fn run<K: Keeper + ?Sized>(
    mesh: &Mesh,
    problem: &Problem,
    attempt: Attempt<'_>,
    options: &Options,
    target: Option<f64>,
    keeping: &mut Keeping<'_, K>,
    observe: &mut (impl Observer + ?Sized),
) -> Result<Ended, SmoothError> {
    let plan = options.plan_to(target);
    let mut floor = Floor::new(mesh, problem);
    let mut positions = problem.positions().to_vec();
    let mut whole: Option<Ended> = None;
    let (mut round, mut is_clean) = (0, false);
    loop {
        round += 1;
        let done = whole.as_ref().map_or(0, |ended| ended.history.len() as u32 - 1);
        let left = options.max_sweeps.saturating_sub(done);
        let most = if is_clean { left } else { left.min(SWEEPS) };
        let part = Options { max_sweeps: most, ..options.clone() };
        let Attempt { device, phase, .. } = attempt;
        let attempt = Attempt { problem, device, phase, done };
        let next = Round { options: &part, plan: &plan, target };
        let (next, new) = floor.round(attempt, next, &mut positions, keeping, observe).await?;
        let is_all = floor.holding.held.iter().all(|held| *held);
        let ended = match whole.take() {
            None => next,
            Some(before) => before.followed_by(next),
        };
        let is_over = matches!(ended.stop, Stop::Canceled | Stop::NotFinite) || left <= most;
        let is_done = is_clean && new == 0 || is_all || round == ROUNDS;
        if is_over || is_done {
            let stop = match ended.stop {
                Stop::MaxSweeps if is_all => Stop::Converged,
                Stop::MaxSweeps | Stop::Converged if round == ROUNDS && new > 0 => Stop::Stalled,
                stop => stop,
            };
            return Ok(Ended { positions, stop, ..ended });
        }
        is_clean = new == 0;
        whole = Some(ended);
    }
}
