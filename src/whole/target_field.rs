//! The stage for targets that belong to points of the plane. After some sweeps, the targets are evaluated at the new
//! positions of the vertices.

use glam::DVec2;

use crate::error::MeshError;
use crate::layout::Problem;
use crate::mesh::Mesh;
use crate::parallel::pace::now;
use crate::run::records::{Reader, Writer};
use crate::run::{NOISE, Stop};
use crate::targets::TargetField;
use crate::whole::host::Host;
use crate::whole::stage::{Judgment, Period, Stage};

/// Number of sweeps in a period.
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

/// The stage that evaluates a field of targets at the vertices after each period.
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

impl Stage for TargetFieldStage<'_> {
    fn name(&self) -> &'static str {
        "target field"
    }

    fn period(&self) -> u32 {
        SWEEPS
    }

    /// Moves the vertices to their swept positions, and evaluates the targets there. Halves the move until f falls by
    /// the new targets and no triangle is inverted. After [`MAX_HALVINGS`] halvings without success, the vertices return to
    /// their former positions.
    fn work(&mut self, host: &mut Host<'_>) -> Result<(), MeshError> {
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

    fn judge(&mut self, period: &Period) -> Judgment {
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

    fn save(&self, out: &mut Writer) {
        out.optional(self.gained);
        out.number(self.settled.into());
        out.number(self.has_moved.into());
        out.number(self.has_followed.into());
    }

    fn restore(&mut self, host: &mut Host<'_>, from: &mut Reader<'_>) -> Option<()> {
        (self.gained, self.settled) = (from.option(Reader::real)?, from.count()?);
        (self.has_moved, self.has_followed) = (from.flag()?, from.flag()?);
        if self.has_followed {
            let before = host.before.clone();
            self.follow_to(host, &before).ok()?;
        }
        Some(())
    }
}
