//! The stage for targets that belong to points of the plane. After some sweeps, the targets are evaluated at the new
//! positions of the vertices.

use glam::DVec2;

use crate::error::MeshError;
use crate::layout::Problem;
use crate::mesh::Mesh;
use crate::parallel::pace::now;
use crate::run::{NOISE, Named, Stop};
use crate::targets::TargetField;
use crate::whole::host::Host;

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

/// A finished period of sweeps, with the targets evaluated at its end.
pub(crate) struct Period {
    /// f by the base metric before and after the period.
    pub(crate) f: [f64; 2],
    /// Whether the run has reached its largest number of sweeps.
    pub(crate) is_last: bool,
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
    /// Creates the stage of a run that ends at the given tolerance, a share of f.
    pub(crate) fn new(mesh: &'s Mesh, field: &'s TargetField, tolerance: f64) -> Self {
        let tolerance = tolerance.max(NOISE);
        Self {
            mesh,
            field,
            tolerance,
            gained: None,
            settled: 0,
            has_moved: true,
            has_followed: false,
        }
    }

    fn follow_to(&mut self, host: &mut Host<'_>, positions: &[DVec2]) -> Result<(), MeshError> {
        host.has_new_targets = true;
        self.has_followed = true;
        set_targets_of(self.field, self.mesh, &mut host.problem, positions)
    }
}

impl TargetFieldStage<'_> {
    /// Largest number of sweeps in a period.
    pub(crate) const SWEEPS: u32 = 5;

    /// Moves the vertices to their swept positions, and evaluates the targets there. Halves the move until f falls by
    /// the new targets and no triangle is inverted. After [`MAX_HALVINGS`] halvings without success, the vertices return to
    /// their former positions.
    ///
    /// # Errors
    /// [`MeshError::NotFinite`] if a position at which a target is needed is infinite or NaN.
    pub(crate) fn work(&mut self, host: &mut Host<'_>) -> Result<(), MeshError> {
        let to = std::mem::take(&mut host.positions);
        let mut share = 1.0;
        self.has_moved = false;
        for _ in 0..=MAX_HALVINGS {
            let way = host.before.iter().zip(&to);
            // With a share of 1, the positions equal the given positions exactly.
            let there: Vec<DVec2> = match share == 1.0 {
                true => to.clone(),
                false => way.map(|(from, to)| *from + (*to - *from) * share).collect(),
            };
            if host.is_sound(&host.before, &there) {
                self.follow_to(host, &there)?;
                if now(host.f(&there)) < host.f_before {
                    (host.positions, self.has_moved) = (there, true);
                    return Ok(());
                }
            }
            share *= 0.5;
        }
        host.positions.clone_from(&host.before);
        let before = host.before.clone();
        self.follow_to(host, &before)?;
        Ok(())
    }

    /// Decides whether the run ends.
    pub(crate) fn judge(&mut self, period: &Period) -> Judgment {
        let [before, last] = period.f;
        let gain = before - last;
        let share = match self.gained {
            Some(before) if before > 0.0 => (gain / before).clamp(0.0, SLOWEST),
            Some(_) => 0.0,
            None => SLOWEST,
        };
        let to_come = gain * (share / (1.0 - share)).max(1.0) / last;
        self.gained = Some(gain);
        self.settled = if to_come <= self.tolerance { self.settled.saturating_add(1) } else { 0 };
        let stop = match self.settled >= SETTLED || !self.has_moved {
            true => Some(Stop::Converged),
            false => period.is_last.then_some(Stop::MaxSweeps),
        };
        // If no part of the move lowers f, the gains of sweeps with constant targets predict nothing.
        let is_estimate = self.has_moved && to_come.is_finite();
        Judgment { stop, remaining: is_estimate.then_some(to_come) }
    }

    /// Returns the state of the stage between two periods.
    pub(crate) fn save(&self) -> Named {
        let mut out = Named::default();
        if let Some(gained) = self.gained {
            out.add("gained", gained);
        }
        out.add("settled", self.settled);
        out.add_flag("moved", self.has_moved);
        out.add_flag("followed", self.has_followed);
        out
    }

    /// Restores a state that [`save`](Self::save) returned. The vertices of `host` have the positions of the saved period.
    /// `None` for an invalid state.
    pub(crate) fn restore(&mut self, host: &mut Host<'_>, from: &Named) -> Option<()> {
        (self.gained, self.settled) = (from.one("gained"), from.one("settled")?);
        (self.has_moved, self.has_followed) = (from.flag("moved")?, from.flag("followed")?);
        if self.has_followed {
            let before = host.before.clone();
            self.follow_to(host, &before).ok()?;
        }
        Some(())
    }
}
