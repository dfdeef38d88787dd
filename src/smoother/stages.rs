//! The stages of a run, which work on the host between sweeps, and the sliding vertices of a run.

use glam::DVec2;

use crate::error::MeshError;
use crate::layout::Problem;
use crate::mesh::Mesh;
use crate::options::Options;
use crate::slide::OnCurves;
use crate::targets::TargetField;
use crate::whole::altitude::least_of;
use crate::whole::{Stage, TargetFieldStage, radii, set_targets_of};

use super::prepared::Smoother;

/// The stages of a run with their state: targets that depend on the place.
pub(super) struct Stages<'s> {
    mesh: &'s Mesh,
    field: Option<&'s TargetField>,
    target_field: Option<TargetFieldStage<'s>>,
}

impl<'s> Stages<'s> {
    /// Makes the stages required by the targets of the smoother.
    pub(super) fn new(smoother: &'s Smoother<'_>, options: &Options) -> Self {
        let Smoother { mesh, field, .. } = smoother;
        let field = field.as_ref();
        let stage = |field| TargetFieldStage::new(mesh, field, options.stopping.tolerance());
        Self { mesh, field, target_field: field.map(stage) }
    }

    /// Returns the stages in the order in which they act.
    pub(super) fn in_order(&mut self) -> Vec<&mut dyn Stage> {
        self.target_field.iter_mut().map(|stage| stage as &mut dyn Stage).collect()
    }

    /// Evaluates the field of targets with the vertices at normalized `positions`. Does nothing without a field.
    pub(super) fn set_targets_at(
        &self,
        problem: &mut Problem,
        positions: &[DVec2],
    ) -> Result<(), MeshError> {
        let set = |field| set_targets_of(field, self.mesh, problem, positions);
        self.field.map_or(Ok(()), set)
    }
}

impl Smoother<'_> {
    /// Returns the sliding vertices at the start of a run, within the bounds of the options. `None` if no vertex slides.
    pub(super) fn on_curves(&self, options: &Options) -> Option<OnCurves> {
        let sliding = self.sliding.clone()?;
        let floor = if options.keep_altitude { least_of(&self.problem) } else { 0.0 };
        let reach = options.max_move.map(|most| {
            let all = radii(&self.mesh, &self.topology, most, options.stored);
            sliding.for_each_vertex(|v| all[v as usize])
        });
        Some(OnCurves::new(sliding, reach, floor))
    }
}
