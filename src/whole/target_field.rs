//! The stage for targets that belong to points of the plane. After some sweeps, the targets are evaluated at the new
//! positions of the vertices.

use glam::DVec2;

use crate::cpu::objective;
use crate::error::MeshError;
use crate::layout::{CornerPart, Problem};
use crate::mesh::Mesh;
use crate::parallel::map_parts;
use crate::run::{NOISE, Named, PeriodState, Plan, Stop};
use crate::targets::TargetField;

/// Largest number of sweeps in a period.
const SWEEPS: u32 = 5;
/// Largest number of times that the stage halves the move of a period, until f falls.
const MAX_HALVINGS: u32 = 4;
/// Number of consecutive periods with remaining gains within the tolerance, after which a run ends.
const SETTLED: u32 = 2;
/// Largest ratio of the gains of two successive periods that an estimate of the remaining gain assumes.
const SLOWEST: f64 = 0.95;

/// Replaces the targets of a problem by the values of a field at the positions of the vertices.
///
/// # Errors
/// [`MeshError::NotFinite`] if a position is not finite.
pub(crate) fn set_targets_of(
    field: &TargetField,
    mesh: &Mesh,
    problem: &mut Problem,
    positions: &[DVec2],
) -> Result<(), MeshError> {
    let points = problem.denormalize(mesh, positions);
    let (targets, _) = field.at(&points)?;
    let converted = problem.converted(&targets, &points);
    problem.set_targets_at(&converted, positions);
    Ok(())
}

/// A decision after a period.
pub(crate) struct Judgment {
    /// Reason why the run ends. `None` if the run continues.
    pub(crate) stop: Option<Stop>,
    /// Estimated remaining gain as a share of f. `None` without an estimate.
    pub(crate) remaining: Option<f64>,
}

/// The stage that evaluates a field of targets at the vertices after each period of sweeps, and decides whether the run ends.
pub(crate) struct TargetFieldStage<'s> {
    mesh: &'s Mesh,
    field: &'s TargetField,
    tolerance: f64,
    /// Number of sweeps before the present period.
    began: u32,
    /// Normalized positions of all vertices before the period.
    before: Vec<DVec2>,
    /// f by the base metric at `before`.
    f_before: f64,
    /// Gain of f in the last period. `None` before the first period.
    gained: Option<f64>,
    /// Number of consecutive periods with remaining gains within the tolerance.
    settled: u32,
    /// Whether vertices moved in the last period.
    has_moved: bool,
    /// True once the stage has evaluated targets again.
    has_followed: bool,
}

impl<'s> TargetFieldStage<'s> {
    /// Creates the stage of a run that ends at the given tolerance, a share of f. A run begins with [`begin`](Self::begin) or
    /// [`restore`](Self::restore).
    pub(crate) fn new(mesh: &'s Mesh, field: &'s TargetField, tolerance: f64) -> Self {
        Self {
            mesh,
            field,
            tolerance: tolerance.max(NOISE),
            began: 0,
            before: Vec::new(),
            f_before: f64::INFINITY,
            gained: None,
            settled: 0,
            has_moved: true,
            has_followed: false,
        }
    }

    /// Begins the first period at the start of a run, with the targets there.
    pub(crate) async fn begin(&mut self, problem: &Problem, plan: &Plan, positions: Vec<DVec2>) {
        let f = objective(plan.scheme.base(), problem, &positions).await;
        self.begin_period(0, positions, f);
    }

    fn follow_to(&mut self, problem: &mut Problem, positions: &[DVec2]) -> Result<(), MeshError> {
        self.has_followed = true;
        set_targets_of(self.field, self.mesh, problem, positions)
    }

    /// Begins a period after `began` sweeps, at positions with the given f by the base metric.
    pub(crate) fn begin_period(&mut self, began: u32, positions: Vec<DVec2>, f: f64) {
        (self.began, self.before, self.f_before) = (began, positions, f);
    }

    /// Returns the number of sweeps before the present period.
    pub(crate) fn began(&self) -> u32 {
        self.began
    }

    /// Returns the last sweep of the present period.
    pub(crate) fn until(&self) -> u32 {
        self.began.saturating_add(SWEEPS)
    }

    /// Moves the vertices to their swept positions `to`, and evaluates the targets there. Halves the move until f falls by
    /// the new targets and no triangle is inverted. After [`MAX_HALVINGS`] halvings without success, the vertices return to
    /// their former positions. Returns the positions of the vertices, and sets the targets of `problem` to those there.
    ///
    /// # Errors
    /// [`MeshError::NotFinite`] if a position at which a target is needed is infinite or NaN.
    pub(crate) async fn work(
        &mut self,
        problem: &mut Problem,
        plan: &Plan,
        to: &[DVec2],
    ) -> Result<Vec<DVec2>, MeshError> {
        let base = plan.scheme.base();
        let guard = plan.base_step(1.0).shape_guard;
        let mut share = 1.0;
        for _ in 0..=MAX_HALVINGS {
            let way = self.before.iter().zip(to);
            // With a share of 1, the positions equal the given positions exactly.
            let there: Vec<DVec2> = match share == 1.0 {
                true => to.to_vec(),
                false => way.map(|(from, to)| *from + (*to - *from) * share).collect(),
            };
            if is_sound(problem, guard, &self.before, &there) {
                self.follow_to(problem, &there)?;
                if objective(base, problem, &there).await < self.f_before {
                    self.has_moved = true;
                    return Ok(there);
                }
            }
            share *= 0.5;
        }
        self.has_moved = false;
        let before = self.before.clone();
        self.follow_to(problem, &before)?;
        Ok(before)
    }

    /// Decides whether the run ends after a period, with f by the present targets. `is_last` tells whether the run has done
    /// its largest number of sweeps.
    pub(crate) fn judge(&mut self, f: f64, is_last: bool) -> Judgment {
        let gain = self.f_before - f;
        let share = match self.gained {
            Some(before) if before > 0.0 => (gain / before).clamp(0.0, SLOWEST),
            Some(_) => 0.0,
            None => SLOWEST,
        };
        let to_come = gain * (share / (1.0 - share)).max(1.0) / f;
        self.gained = Some(gain);
        self.settled = if to_come <= self.tolerance { self.settled.saturating_add(1) } else { 0 };
        let stop = match self.settled >= SETTLED || !self.has_moved {
            true => Some(Stop::Converged),
            false => is_last.then_some(Stop::MaxSweeps),
        };
        // If no part of the move lowers f, the gains of sweeps with constant targets predict nothing.
        let is_estimate = self.has_moved && to_come.is_finite();
        // An extrapolation cannot show less than the tolerance: slow modes may remain.
        let least = if stop == Some(Stop::Converged) { self.tolerance } else { 0.0 };
        Judgment { stop, remaining: is_estimate.then_some(to_come.max(least)) }
    }

    /// Returns the state of the stage in the present period.
    pub(crate) fn save(&self) -> PeriodState {
        let mut out = Named::default();
        if let Some(gained) = self.gained {
            out.add("gained", gained);
        }
        out.add("settled", self.settled);
        out.add_flag("moved", self.has_moved);
        out.add_flag("followed", self.has_followed);
        let &Self { began, f_before, .. } = self;
        PeriodState { began, before: self.before.clone(), f_before, stage: out }
    }

    /// Restores a state that [`save`](Self::save) returned, and the targets of `problem` in that state. `None` for an invalid
    /// state.
    pub(crate) fn restore(&mut self, problem: &mut Problem, from: &PeriodState) -> Option<()> {
        let PeriodState { began, before, f_before, stage } = from;
        self.begin_period(*began, before.clone(), *f_before);
        (self.gained, self.settled) = (stage.one("gained"), stage.one("settled")?);
        (self.has_moved, self.has_followed) = (stage.flag("moved")?, stage.flag("followed")?);
        if self.has_followed {
            self.follow_to(problem, before).ok()?;
        }
        Some(())
    }
}

/// Returns whether a move from `from` to `to` is sound: no corner may become inverted or flat, and none may have an inverse
/// mean ratio both above the guard and worse than before.
fn is_sound(problem: &Problem, guard: f64, from: &[DVec2], to: &[DVec2]) -> bool {
    let are_sound = |_, CornerPart { corners, is_right }: CornerPart<'_>| {
        let ratio = |positions: &[DVec2], t: &[u32; 3]| {
            problem.corner_of(is_right, t, |v| positions[v as usize]).inverse_mean_ratio()
        };
        corners.iter().all(|t| {
            let now = ratio(to, t);
            now.is_finite() && (now <= guard || now <= ratio(from, t))
        })
    };
    let parts = problem.corner_parts().into_iter().flat_map(|part| part.chunks(4096));
    map_parts(parts.collect::<Vec<_>>(), are_sound).into_iter().all(|are_sound| are_sound)
}
