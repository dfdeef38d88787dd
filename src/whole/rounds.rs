//! Runs in which vertices slide: rounds of sweeps over the free vertices, on the engine, each followed by sweeps along the curves, on
//! the host.

use glam::DVec2;

use crate::cpu::mean_excess;
use crate::error::SmoothError;
use crate::layout::Problem;
use crate::mesh::Mesh;
use crate::outcome::Slid;
use crate::parallel::map_parts;
use crate::run::{
    Derivatives, Desired, Goal, Guard, Keeper, Keeping, Objectives, Observer, Options, Plan, Stop,
    StopRule, set_guards,
};
use crate::slide::{Acceleration, Params, Sliding};
use crate::topology::Topology;
use crate::topology::predicates::orientation;
use crate::whole::attempt::{Attempt, Ended};

/// Number of sweeps in a round. With two a run takes as many sweeps and more rounds, with four more sweeps.
const SWEEPS: u32 = 3;
/// How often a round goes along the curves, forward and back. They have so few vertices that it costs little.
const SLIDES: u32 = 3;
/// A run is over once as many estimates in a row say so, as the gains of accelerated rounds are irregular.
const ESTIMATES: u32 = 2;

/// The vertices that slide, and where a run has brought them.
pub(crate) struct Rounds<'s> {
    pub(crate) sliding: &'s Sliding,
    pub(crate) params: Params,
    /// Number of rounds done.
    pub(crate) count: u32,
}

impl<'s> Rounds<'s> {
    pub(crate) fn new(sliding: &'s Sliding) -> Self {
        Self { sliding, params: sliding.start(), count: 0 }
    }

    /// Checks that a run by these options can go in rounds, as `option` asks for.
    pub(crate) fn check(
        option: &'static str,
        options: &Options,
        is_continued: bool,
    ) -> Result<(), SmoothError> {
        let refuse = |remedy| Err(SmoothError::Option { option, value: "on".to_owned(), remedy });
        if options.scheme.period() > 1 || !options.scheme.is_monotone() {
            return refuse("it needs one metric other than edge: take imr, say");
        }
        if options.derivatives != Derivatives::Analytic {
            return refuse("it needs exact derivatives");
        }
        if matches!(options.goal, Some(Goal { desired: Desired::Auto, .. })) {
            return refuse("the desired f is not sought in such a run: give its value");
        }
        match is_continued {
            true => refuse("such a run is not continued from a checkpoint: start anew"),
            false => Ok(()),
        }
    }

    /// Sweeps from the positions of the problem until the run ends. f at the end of each round judges.
    pub(crate) async fn run<K: Keeper + ?Sized>(
        &mut self,
        mut attempt: Attempt<'_>,
        options: &Options,
        target: Option<f64>,
        keeping: &mut Keeping<'_, K>,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Ended, SmoothError> {
        let problem = attempt.problem;
        let mut plan = options.plan_to(target);
        set_guards(&mut plan, options.guard, problem, problem.positions());
        let rule = StopRule { max_sweeps: u32::MAX, ..plan.stop };
        let mut positions = problem.positions().to_vec();
        let mut memory = Acceleration::default();
        let (mut before, mut f, mut estimates) = (None::<Ended>, Vec::new(), 0);
        loop {
            attempt.done = before.as_ref().map_or(0, |ended| ended.history.len() as u32 - 1);
            let left = options.max_sweeps.saturating_sub(attempt.done);
            let part = Options { max_sweeps: left.min(SWEEPS), ..options.clone() };
            let mut next =
                attempt.sweep(&part, target, (&positions, None), keeping, observe).await?;
            positions = std::mem::take(&mut next.positions);
            let mut ended = match before.take() {
                None => next,
                Some(before) => before.followed_by(next),
            };
            let is_over = matches!(ended.stop, Stop::Reached | Stop::Cancelled | Stop::NotFinite);
            let mut stop = Some(ended.stop);
            if !is_over && left > 0 {
                let objectives = self.slide(problem, &plan, &mut positions, &mut memory);
                // The slide is a part of the round's last sweep.
                if let Some(last) = ended.history.last_mut() {
                    *last = objectives;
                }
                f.push(objectives.of(options.scheme.base()).unwrap_or(f64::NAN));
                let judged = rule.judge(&f, f.len() - 1, 1);
                estimates = if judged.is_some() { estimates + 1 } else { 0 };
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

    /// What slid in rounds that ended at `points`, or at the mesh as it was if nothing was gained.
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
            rounds: self.count,
            off: if gains { self.sliding.off(&self.params) } else { 0.0 },
            area: area(points) / area(before) - 1.0,
        }
    }

    /// Goes along the curves. Then goes on as the last rounds did, if that lowers the objective. Returns the objectives.
    fn slide(
        &mut self,
        problem: &Problem,
        plan: &Plan,
        positions: &mut Vec<DVec2>,
        memory: &mut Acceleration,
    ) -> Objectives {
        self.count += 1;
        let (step, base) = (plan.base_step(1.0), plan.scheme.base());
        let began = self.params.clone();
        for _ in 0..SLIDES {
            self.sliding.sweep(problem, &mut self.params, positions, &step);
        }
        let here = objectives(problem, plan, positions);
        let change = self.sliding.change(&began, &self.params);
        let Some((mut params, mut there)) = memory.next(change, &self.params, positions) else {
            return here;
        };
        if self.sliding.place(problem, &mut params, &self.params, &mut there)
            && is_sound(problem, positions, &there, step.shape_guard)
        {
            let lower = objectives(problem, plan, &there);
            if lower.of(base) < here.of(base) {
                (self.params, *positions) = (params, there);
                return lower;
            }
        }
        memory.forget();
        here
    }
}

/// The objectives that a plan asks for.
pub(crate) fn objectives(problem: &Problem, plan: &Plan, positions: &[DVec2]) -> Objectives {
    let mut objectives = Objectives::untracked();
    for metric in plan.tracked() {
        let excess = mean_excess(metric, problem, positions);
        objectives.set(metric, metric.ideal_squared() + excess);
    }
    objectives
}

/// Whether no triangle is inverted or flat after a move, or has an inverse mean ratio that is worse than before and above `guard`.
pub(crate) fn is_sound(problem: &Problem, before: &[DVec2], after: &[DVec2], guard: f64) -> bool {
    let ratio = |positions: &[DVec2], t: &[u32; 3]| {
        problem.corner(t, |v| positions[v as usize]).inverse_mean_ratio()
    };
    let is_sound = |t: &[u32; 3]| {
        let now = ratio(after, t);
        now.is_finite() && (now <= guard || now <= ratio(before, t))
    };
    let parts = map_parts(problem.triangles().chunks(4096), |_, part| part.iter().all(is_sound));
    parts.into_iter().all(|is_sound| is_sound)
}
