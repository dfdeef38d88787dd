//! Runs in which vertices slide. They consist of rounds: sweeps over the free vertices, on the engine, followed by
//! sweeps along the curves, on the host.

use glam::DVec2;

use crate::error::SmoothError;
use crate::layout::Problem;
use crate::mesh::Mesh;
use crate::outcome::Slid;
use crate::run::{
    Guard, Keeper, Keeping, Objectives, Observer, Options, Plan, Stop, StopRule, set_guards,
};
use crate::slide::{Acceleration, Params, Rule, Sliding};
use crate::topology::Topology;
use crate::topology::predicates::orientation;
use crate::whole::altitude::Floor;
use crate::whole::attempt::{Attempt, Ended, Round};
use crate::whole::in_rounds::{is_sound, objectives};
use crate::whole::limit::Limit;

/// Number of sweeps in a round. With two, a run takes as many sweeps and more rounds; with four, it takes more sweeps.
const SWEEPS: u32 = 3;
/// Number of times that a round sweeps along the curves, forward and back. Curves have so few vertices that it costs
/// little.
const SLIDES: u32 = 3;
/// Number of estimates in a row that must agree before a run ends, as the gains of accelerated rounds are irregular.
const ESTIMATES: u32 = 2;

/// The share of an altitude that rounding may take.
const ROUNDING: f64 = 1e-9;

/// A bound that a run keeps for all vertices.
pub(crate) enum Bound<'b, 's> {
    /// No bound.
    None,
    /// A bound on how far each vertex may move.
    Moves(&'b mut Limit<'s>),
    /// A bound on the altitude of triangles.
    Altitudes(&'b mut Floor<'s>),
}

impl Bound<'_, '_> {
    /// Whether the positions keep the bound.
    fn holds_at(&self, positions: &[DVec2]) -> bool {
        match self {
            Self::None => true,
            Self::Moves(limit) => limit.holds_at(positions),
            Self::Altitudes(floor) => floor.holds_at(positions),
        }
    }
}

/// The vertices that slide, and where the run has moved them.
pub(crate) struct Rounds<'s> {
    pub(crate) sliding: &'s Sliding,
    pub(crate) params: Params,
    /// How far each vertex may be from its given position, in the unit of the mesh.
    reach: Params,
    /// The least altitude that sliding may leave, normalized; 0 for no bound.
    floor: f64,
    /// Number of rounds done.
    pub(crate) count: u32,
}

impl<'s> Rounds<'s> {
    pub(crate) fn new(sliding: &'s Sliding) -> Self {
        let reach = sliding.for_each_vertex(|_| f64::INFINITY);
        Self { sliding, params: sliding.start(), reach, floor: 0.0, count: 0 }
    }

    /// Sweeps from the positions of the problem until the run ends, judged by f at the end of each round.
    pub(crate) async fn run<K: Keeper + ?Sized>(
        &mut self,
        attempt: Attempt<'_>,
        options: &Options,
        target: Option<f64>,
        mut bound: Bound<'_, '_>,
        keeping: &mut Keeping<'_, K>,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Ended, SmoothError> {
        let problem = attempt.problem;
        let mut plan = options.plan_to(target);
        set_guards(&mut plan, options.guard, problem, problem.positions());
        let rule = StopRule { max_sweeps: u32::MAX, ..plan.stop };
        match &bound {
            Bound::None => {}
            Bound::Moves(limit) => self.reach = limit.reach(self.sliding),
            Bound::Altitudes(floor) => self.floor = floor.least * (1.0 + ROUNDING),
        }
        let mut positions = problem.positions().to_vec();
        let mut memory = Acceleration::default();
        let (mut before, mut f, mut estimates) = (None::<Ended>, Vec::new(), 0);
        loop {
            let done = before.as_ref().map_or(0, |ended| ended.history.len() as u32 - 1);
            let left = options.max_sweeps.saturating_sub(done);
            let part = Options { max_sweeps: left.min(SWEEPS), ..options.clone() };
            let Attempt { device, phase, .. } = attempt;
            let attempt = Attempt { problem, device, phase, done };
            let round = Round { options: &part, plan: &plan, target };
            let (next, is_settled) = match &mut bound {
                Bound::Moves(limit) => {
                    limit.round(attempt, round, &mut positions, keeping, observe).await?
                }
                Bound::Altitudes(floor) => {
                    let round = floor.round(attempt, round, &mut positions, keeping, observe);
                    let (next, new) = round.await?;
                    (next, new == 0)
                }
                Bound::None => {
                    let from = &positions[..];
                    let mut next =
                        attempt.sweep(&part, target, from, None, keeping, observe).await?;
                    positions = std::mem::take(&mut next.positions);
                    (next, true)
                }
            };
            let mut ended = match before.take() {
                None => next,
                Some(before) => before.followed_by(next),
            };
            let is_over = match ended.stop {
                Stop::Canceled | Stop::NotFinite => true,
                // With bounds, this is known only at the end of the round.
                Stop::Reached => matches!(bound, Bound::None),
                _ => false,
            };
            let mut stop = Some(ended.stop);
            if !is_over && left > 0 {
                let objectives =
                    self.slide(problem, &plan, &mut positions, &mut memory, &mut bound);
                // Sliding counts as a part of the round's last sweep.
                if let Some(last) = ended.history.last_mut() {
                    *last = objectives;
                }
                f.push(objectives.of(options.scheme.base()).unwrap_or(f64::NAN));
                let judged = rule.judge(&f, f.len() - 1, 1);
                estimates = if judged.is_some() && is_settled { estimates + 1 } else { 0 };
                ended.remaining = rule.remaining(&f, 1);
                let is_last = left <= SWEEPS && ended.stop == Stop::MaxSweeps;
                stop = match judged {
                    Some(Stop::Reached) => judged,
                    Some(_) if estimates >= ESTIMATES => judged,
                    _ => is_last.then_some(Stop::MaxSweeps),
                };
            }
            if let Some(stop) = stop {
                let is_held = stop == Stop::Converged
                    && ended.held_back > 0
                    && options.guard == Guard::ByMetric;
                let stop = if is_held { Stop::HeldBack } else { stop };
                return Ok(Ended { positions, stop, ..ended });
            }
            before = Some(ended);
        }
    }

    /// Returns the result of sliding in rounds that ended at `points`. If nothing was gained, it is that of the
    /// unchanged mesh.
    pub(crate) fn slid(
        &self,
        mesh: &Mesh,
        topology: &Topology<'_>,
        gains: bool,
        points: &[[f64; 2]],
    ) -> Slid {
        let (before, free) = (&mesh.points, topology.free());
        let moved = (0..free.len()).filter(|&v| !free[v] && points[v] != before[v]).count();
        let area = |points: &[[f64; 2]]| {
            let of = |t: &[u32; 3]| orientation(points, t);
            topology.triangles().iter().map(of).sum::<f64>()
        };
        Slid {
            vertices: self.sliding.count(),
            moved,
            pairs: self.sliding.pairs()[0],
            rounds: self.count,
            off: if gains { self.sliding.off(&self.params) } else { 0.0 },
            area: area(points) / area(before) - 1.0,
        }
    }

    /// Sweeps along the curves. Then takes the accelerated step from the last rounds, if that lowers the objective.
    /// Returns the objectives.
    fn slide(
        &mut self,
        problem: &Problem,
        plan: &Plan,
        positions: &mut Vec<DVec2>,
        memory: &mut Acceleration,
        bound: &mut Bound<'_, '_>,
    ) -> Objectives {
        self.count += 1;
        let (step, base) = (plan.base_step(1.0), plan.scheme.base());
        let began = self.params.clone();
        for _ in 0..SLIDES {
            let rule = Rule { step: &step, floor: self.floor };
            self.sliding.sweep(problem, &mut self.params, &self.reach, positions, rule);
        }
        let here = objectives(problem, plan, positions);
        let change = self.sliding.change(&began, &self.params);
        let Some((mut params, mut there)) = memory.next(change, &self.params, positions) else {
            return here;
        };
        let (safe, reach) = (&self.params, &self.reach);
        if self.sliding.place(problem, &mut params, safe, reach, &mut there)
            && bound.holds_at(&there)
            && is_sound(problem, positions, &there, step.shape_guard)
        {
            let lower = objectives(problem, plan, &there);
            if lower.of(base) < here.of(base) {
                (self.params, *positions) = (params, there);
                if let Bound::Moves(limit) = bound {
                    limit.find_held(positions);
                }
                return lower;
            }
        }
        memory.forget();
        here
    }
}
