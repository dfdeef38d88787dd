//! Runs in which no vertex moves farther than a bound. They consist of rounds of sweeps on the engine, after each of
//! which vertices beyond their bound are brought back to it.

use glam::DVec2;

use crate::error::SmoothError;
use crate::layout::Problem;
use crate::measure::mean_edges;
use crate::mesh::Mesh;
use crate::precision::Precision;
use crate::run::{
    Keeper, Keeping, Observer, Options, Plan, Step, Stop, StopRule, line_search, set_guards,
};
use crate::slide::{Fan, Params, Patch, Sliding};
use crate::topology::Topology;
use crate::whole::attempt::{Attempt, Ended, Round};
use crate::whole::holding::Holding;
use crate::whole::in_rounds::{self, is_sound, objectives};

/// Number of sweeps in a round.
const SWEEPS: u32 = 3;
/// Number of times that a round visits the vertices at their bound.
const VISITS: u32 = 3;
/// Number of times that the move of a round is halved if it cannot be taken.
const HALVED: u32 = 5;
/// Number of estimates in a row that must agree before a run ends.
const ESTIMATES: u32 = 2;
/// A vertex that has moved by more than this share of its bound is at its bound.
const AT_BOUND: f64 = 1.0 - 1e-6;

/// How far each vertex may move, and which free vertices are at their bound.
pub(crate) struct Limit<'s> {
    problem: &'s Problem,
    /// The largest distance of each vertex of the mesh from its start, in the unit of the mesh.
    all: Vec<f64>,
    /// The largest distance of each free vertex from its start, normalized.
    bounds: Vec<f64>,
    /// Which free vertices are at their bound.
    holding: Holding<'s>,
    fans: Vec<Fan>,
}

impl<'s> Limit<'s> {
    /// Makes bounds so that no vertex moves by more than `most` times the mean edge length there, given the precision
    /// in which positions are stored.
    pub(crate) fn new(
        mesh: &'s Mesh,
        topology: &Topology<'_>,
        problem: &'s Problem,
        most: f64,
        stored: Precision,
    ) -> Self {
        let edges = mean_edges(topology, &mesh.points);
        let bound = |([x, y], edge): (&[f64; 2], &f64)| {
            let rounding = 2.0 * stored.error(x.abs().max(y.abs()));
            (most * edge * (1.0 - 1e-9) - rounding).max(0.0)
        };
        let all: Vec<f64> = mesh.points.iter().zip(&edges).map(bound).collect();
        let (_, scale) = problem.normalization();
        let holding = Holding::new(mesh, problem);
        let free = &problem.vertices()[..problem.free_count()];
        let fan = |&v: &u32| {
            let mut fan = Fan::new(topology, v);
            fan.renumber(&holding.number);
            fan
        };
        Self {
            problem,
            bounds: free.iter().map(|&v| all[v as usize] * scale).collect(),
            all,
            fans: free.iter().map(fan).collect(),
            holding,
        }
    }

    /// Returns how far each free vertex may be from its start, normalized.
    pub(crate) fn bounds(&self) -> &[f64] {
        &self.bounds
    }

    /// Sweeps from the positions of the problem until the run ends, judged by f at the end of each round.
    pub(crate) async fn run<K: Keeper + ?Sized>(
        &mut self,
        attempt: Attempt<'_>,
        options: &Options,
        target: Option<f64>,
        keeping: &mut Keeping<'_, K>,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Ended, SmoothError> {
        let mut plan = options.plan_to(target);
        set_guards(&mut plan, options.guard, self.problem, self.problem.positions());
        let (rule, base) = (StopRule { max_sweeps: u32::MAX, ..plan.stop }, plan.scheme.base());
        let mut positions = self.problem.positions().to_vec();
        let start = objectives(self.problem, &plan, &positions);
        let mut whole: Option<Ended> = None;
        let (mut f, mut estimates) = (vec![start.of(base).unwrap_or(f64::NAN)], 0);
        loop {
            let done = whole.as_ref().map_or(0, |ended| ended.history.len() as u32 - 1);
            let left = options.max_sweeps.saturating_sub(done);
            let part = Options { max_sweeps: left.min(SWEEPS), ..options.clone() };
            let Attempt { device, phase, .. } = attempt;
            let attempt = Attempt { problem: self.problem, device, phase, done };
            let round = Round { options: &part, plan: &plan, target };
            let (next, is_settled) =
                self.round(attempt, round, &mut positions, keeping, observe).await?;
            let last = objectives(self.problem, &plan, &positions).of(base).unwrap_or(f64::NAN);
            let ended = match whole.take() {
                None => next,
                Some(before) => before.followed_by(next),
            };
            f.push(last);
            let judged = rule.judge(&f[1..], f.len() - 2, 1);
            let is_settled = judged.is_some() && is_settled;
            estimates = if is_settled { estimates + 1 } else { 0 };
            let is_over = matches!(ended.stop, Stop::Canceled | Stop::NotFinite) || left == 0;
            let is_last = left <= SWEEPS && ended.stop == Stop::MaxSweeps
                || f.len() > options.max_sweeps as usize;
            let stop = match judged {
                _ if is_over => Some(ended.stop),
                Some(Stop::Reached) => judged,
                Some(_) if estimates >= ESTIMATES => judged,
                _ => is_last.then_some(Stop::MaxSweeps),
            };
            let remaining = rule.remaining(&f[1..], 1);
            match stop {
                Some(stop) => return Ok(Ended { positions, stop, remaining, ..ended }),
                None => whole = Some(ended),
            }
        }
    }

    /// Does a round, which moves the vertices from `positions`: sweeps on the engine, after which vertices beyond their
    /// bound are brought back. Returns the end of the round without positions, and whether the sweeps moved vertices or
    /// the same vertices are held as before. Gains beyond the bounds do not count in its history.
    pub(crate) async fn round<K: Keeper + ?Sized>(
        &mut self,
        attempt: Attempt<'_>,
        round: Round<'_>,
        positions: &mut Vec<DVec2>,
        keeping: &mut Keeping<'_, K>,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<(Ended, bool), SmoothError> {
        let Round { options: part, plan, target } = round;
        let base = plan.scheme.base();
        // Vertices at their bound are fixed for the engine.
        let smaller = self.holding.smaller()?;
        let problem = smaller.as_ref().unwrap_or(self.problem);
        let from = self.holding.renumbered(positions, problem);
        let attempt = Attempt { problem, ..attempt };
        let mut next = attempt.sweep(part, target, &from, None, keeping, observe).await?;
        let to = self.holding.numbered_back(&std::mem::take(&mut next.positions), problem);
        let before = self.holding.held.clone();
        let has_moved = self.take(plan, positions, &to);
        for _ in 0..VISITS {
            self.visit_held(positions, &plan.base_step(1.0));
        }
        if has_moved {
            self.find_held(positions);
        }
        let now = objectives(self.problem, plan, positions);
        let last = now.of(base).unwrap_or(f64::NAN);
        // Gains beyond the bounds do not count.
        for entry in next.history.iter_mut().skip(1) {
            if entry.of(base).is_none_or(|f| f < last) {
                *entry = now;
            }
        }
        if let (Some(entry), true) = (next.history.last_mut(), part.max_sweeps > 0) {
            *entry = now;
        }
        Ok((next, has_moved || before == self.holding.held))
    }

    /// Whether all free vertices are within their bounds.
    pub(crate) fn holds_at(&self, positions: &[DVec2]) -> bool {
        let start = self.problem.positions().iter().zip(positions);
        start.zip(&self.bounds).all(|((start, now), bound)| now.distance(*start) <= *bound)
    }

    /// Returns how far each vertex that slides may be from its given position, in the unit of the mesh.
    pub(crate) fn reach(&self, sliding: &Sliding) -> Params {
        sliding.for_each_vertex(|v| self.all[v as usize])
    }

    /// Returns the position of a free vertex, brought back to its bound if it is beyond.
    fn within(&self, v: usize, to: DVec2) -> DVec2 {
        let (start, bound) = (self.problem.positions()[v], self.bounds[v]);
        let distance = to.distance(start);
        if distance <= bound { to } else { start + (to - start) * (bound / distance) }
    }

    /// Moves the vertices toward `to` as far as bounds allow, or a part of the way, if that lowers the objective and is
    /// sound. If not, vertices that would go beyond their bounds are held. Returns whether the vertices were moved.
    fn take(&mut self, plan: &Plan, positions: &mut Vec<DVec2>, to: &[DVec2]) -> bool {
        let (problem, base) = (self.problem, plan.scheme.base());
        let here = objectives(problem, plan, positions).of(base);
        let guard = plan.base_step(1.0).shape_guard;
        let mut share = 1.0;
        for _ in 0..=HALVED {
            let mut there = positions.clone();
            for (v, (place, to)) in there[..self.bounds.len()].iter_mut().zip(to).enumerate() {
                // With a share of 1, the position is exactly that of `to`.
                let wanted = if share == 1.0 { *to } else { *place + (*to - *place) * share };
                *place = self.within(v, wanted);
            }
            if is_sound(problem, positions, &there, guard)
                && objectives(problem, plan, &there).of(base) < here
            {
                *positions = there;
                return true;
            }
            share *= 0.5;
        }
        let beyond = |(v, to): (usize, &DVec2)| (self.within(v, *to) != *to).then_some(v);
        let free = &to[..self.holding.held.len()];
        let beyond: Vec<usize> = free.iter().enumerate().filter_map(beyond).collect();
        beyond.into_iter().for_each(|v| self.holding.held[v] = true);
        false
    }

    /// Visits the vertices at their bound: a step along the negative gradient, brought back within the bound.
    fn visit_held(&self, positions: &mut [DVec2], step: &Step) {
        for v in (0..self.holding.held.len()).filter(|&v| self.holding.held[v]) {
            let here = positions[v];
            let fan = &self.fans[v];
            let patch = Patch { problem: self.problem, positions, fan, step, floor: 0.0 };
            let sum = patch.derivatives(here);
            let gradient = DVec2::from(sum.gradient);
            let [xx, xy, yy] = sum.hessian;
            let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
            let most = mean.abs() + (half * half + xy * xy).sqrt();
            // The step is the gradient divided by the largest curvature. It moves a vertex along its bound as well as
            // inward.
            let way = -gradient / most;
            if !way.is_finite() {
                continue;
            }
            let limit = match step.shape_guard.is_finite() {
                true => step.shape_guard.max(patch.worst_shape(here)),
                false => f64::INFINITY,
            };
            let mut length = 1.0;
            for _ in 0..line_search::TRIALS {
                let to = self.within(v, here + way * length);
                if patch.objective(to, limit).is_some_and(|value| value < sum.value) {
                    positions[v] = to;
                    break;
                }
                length *= line_search::SHORTEN;
            }
        }
    }

    /// Finds the vertices at their bound. Vertices that were held and are inside their bound are released.
    pub(crate) fn find_held(&mut self, positions: &[DVec2]) {
        for (v, held) in self.holding.held.iter_mut().enumerate() {
            let distance = positions[v].distance(self.problem.positions()[v]);
            *held = distance >= AT_BOUND * self.bounds[v];
        }
    }

    /// Checks that bounds are possible in a run with these options.
    pub(crate) fn check(options: &Options, is_continued: bool) -> Result<(), SmoothError> {
        in_rounds::check("max move", options, is_continued)
    }
}
