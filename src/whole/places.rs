//! Runs whose targets belong to points of the plane: rounds of sweeps, between which targets are evaluated at the new
//! positions of the vertices.

use glam::DVec2;

use crate::error::{MeshError, SmoothError};
use crate::layout::Problem;
use crate::mesh::Mesh;
use crate::run::{Keeper, Keeping, NOISE, Objectives, Observer, Options, Plan, Stop, set_guards};
use crate::targets::TargetField;
use crate::whole::attempt::{Attempt, Ended};
use crate::whole::in_rounds::{self, is_sound, objectives};

/// Number of sweeps in a round.
const SWEEPS: u32 = 5;
/// Number of times that the move of a round is halved if f does not fall along it.
const HALVED: u32 = 4;
/// Number of rounds in a row with gains of at most the tolerance, after which a run ends.
const SETTLED: u32 = 2;
/// When the remaining gain is estimated from the gains of two rounds, the second counts as at most this share of the
/// first.
const SLOWEST: f64 = 0.95;

/// A problem whose targets follow its vertices.
pub(crate) struct Places<'s> {
    mesh: &'s Mesh,
    field: &'s TargetField,
    /// The problem with the targets at the last positions of the vertices.
    pub(crate) problem: Problem,
}

impl<'s> Places<'s> {
    pub(crate) fn new(mesh: &'s Mesh, field: &'s TargetField, problem: &Problem) -> Self {
        Self { mesh, field, problem: problem.clone() }
    }

    /// Checks that targets can follow the vertices in a run with these options.
    pub(crate) fn check(options: &Options, is_continued: bool) -> Result<(), SmoothError> {
        let option = "target field";
        let refuse = |value: &str, remedy| {
            Err(SmoothError::Option { option, value: value.to_owned(), remedy })
        };
        if options.goal.is_some() {
            return refuse(
                "with a goal",
                "as targets change, there is no desired f: leave out one of the two",
            );
        }
        if options.max_move.is_some() {
            return refuse("with a bound", "leave out one of the two, or set targets of vertices");
        }
        in_rounds::check(option, options, is_continued)
    }

    /// Evaluates the targets at the positions of the vertices.
    pub(crate) fn follow(&mut self, positions: &[DVec2]) -> Result<(), MeshError> {
        let points = self.problem.denormalize(self.mesh, positions);
        let (targets, _) = self.field.at(&points)?;
        self.problem.set_targets_at(targets.maps(), positions);
        Ok(())
    }

    /// Sweeps from the positions of the problem until f no longer falls. f is evaluated at the end of each round, with
    /// the targets at the positions of the vertices.
    pub(crate) async fn run<K: Keeper + ?Sized>(
        &mut self,
        attempt: Attempt<'_>,
        options: &Options,
        keeping: &mut Keeping<'_, K>,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Ended, SmoothError> {
        let mut plan = options.plan_to(None);
        set_guards(&mut plan, options.guard, &self.problem, self.problem.positions());
        let tolerance = options.tolerance.max(NOISE);
        let mut positions = self.problem.positions().to_vec();
        let mut here = objectives(&self.problem, &plan, &positions);
        let (mut whole, mut gained, mut settled) = (None::<Ended>, None::<f64>, 0);
        loop {
            let done = whole.as_ref().map_or(0, |ended| ended.history.len() as u32 - 1);
            let left = options.max_sweeps.saturating_sub(done);
            let part = Options { max_sweeps: left.min(SWEEPS), ..options.clone() };
            let Attempt { device, phase, .. } = attempt;
            let attempt = Attempt { problem: &self.problem, device, phase, done };
            let mut next = attempt.sweep(&part, None, &positions, None, keeping, observe).await?;
            let f = |objectives: &Objectives| objectives.of(plan.scheme.base()).unwrap_or(f64::NAN);
            let before = f(&here);
            let to = std::mem::take(&mut next.positions);
            let has_moved = self.take(&plan, &mut positions, &mut here, &to)?;
            let last = f(&here);
            // Gains by targets that are no longer valid do not count.
            let count = next.history.len() - 1;
            for (k, entry) in next.history.iter_mut().enumerate().skip(1) {
                if k == count || f(entry) < last {
                    *entry = here;
                }
            }
            let gain = before - last;
            let share = match gained {
                Some(before) if before > 0.0 => (gain / before).clamp(0.0, SLOWEST),
                Some(_) => 0.0,
                None => SLOWEST,
            };
            let to_come = gain * (share / (1.0 - share)).max(1.0) / last;
            gained = Some(gain);
            settled = if to_come <= tolerance { settled + 1 } else { 0 };
            let ended = match whole.take() {
                None => next,
                Some(before) => before.followed_by(next),
            };
            let stop = match ended.stop {
                stop @ (Stop::Canceled | Stop::NotFinite) => Some(stop),
                _ if left == 0 => Some(Stop::MaxSweeps),
                stop if settled >= SETTLED || !has_moved => Some(match stop {
                    Stop::HeldBack => stop,
                    _ => Stop::Converged,
                }),
                _ => (left <= SWEEPS).then_some(Stop::MaxSweeps),
            };
            if let Some(stop) = stop {
                let remaining = to_come.is_finite().then_some(to_come);
                return Ok(Ended { positions, stop, remaining, ..ended });
            }
            whole = Some(ended);
        }
    }

    /// Moves the vertices to the given positions, or a part of the way, if that lowers f with the targets there and
    /// inverts nothing. The problem then has the targets at the new positions. Returns whether the vertices were moved.
    fn take(
        &mut self,
        plan: &Plan,
        positions: &mut Vec<DVec2>,
        here: &mut Objectives,
        to: &[DVec2],
    ) -> Result<bool, MeshError> {
        let (base, guard) = (plan.scheme.base(), plan.base_step(1.0).shape_guard);
        let mut share = 1.0;
        for _ in 0..=HALVED {
            let way = positions.iter().zip(to);
            // With a share of 1, the positions are exactly the given ones.
            let there: Vec<DVec2> = match share == 1.0 {
                true => to.to_vec(),
                false => way.map(|(from, to)| *from + (*to - *from) * share).collect(),
            };
            if is_sound(&self.problem, positions, &there, guard) {
                self.follow(&there)?;
                let lower = objectives(&self.problem, plan, &there);
                if lower.of(base) < here.of(base) {
                    (*positions, *here) = (there, lower);
                    return Ok(true);
                }
            }
            share *= 0.5;
        }
        self.follow(positions)?;
        Ok(false)
    }
}
