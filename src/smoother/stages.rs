//! The stages of a run, which work on the host between sweeps.

use glam::DVec2;

use crate::error::MeshError;
use crate::layout::Problem;
use crate::mesh::Mesh;
use crate::options::Options;
use crate::outcome::Slid;
use crate::run::Plan;
use crate::slide::Sliding;
use crate::targets::TargetField;
use crate::topology::Topology;
use crate::whole::altitude::least_of;
use crate::whole::{SlideStage, Stage, TargetFieldStage, radii, set_targets_of};

use super::prepared::Smoother;

/// The stages of a run with their state: sliding, and targets that depend on the place.
pub(super) struct Stages<'s> {
    mesh: &'s Mesh,
    topology: &'s Topology<'s>,
    field: Option<&'s TargetField>,
    slide: Option<SlideStage<'s>>,
    target_field: Option<TargetFieldStage<'s>>,
}

impl<'s> Stages<'s> {
    /// Makes the stages required by the curves and targets of the smoother, and by the options.
    pub(super) fn new(smoother: &'s Smoother<'_>, options: &Options, plan: &Plan) -> Self {
        let Smoother { mesh, topology, problem, sliding, field, .. } = smoother;
        let floor = if options.keep_altitude { least_of(problem) } else { 0.0 };
        let slide = |sliding: &'s Sliding| {
            let reach = options.max_move.map(|most| {
                let all = radii(mesh, topology, most, options.stored);
                sliding.for_each_vertex(|v| all[v as usize])
            });
            SlideStage::new(sliding, reach, floor, plan.stop)
        };
        let slide = sliding.as_ref().map(slide);
        let field = field.as_ref();
        Self {
            mesh,
            topology,
            field,
            slide,
            target_field: field
                .map(|field| TargetFieldStage::new(mesh, field, options.stopping.tolerance())),
        }
    }

    /// Returns the stages in the order in which they act.
    pub(super) fn in_order(&mut self) -> Vec<&mut dyn Stage> {
        let Self { slide, target_field, .. } = self;
        let mut stages: Vec<&mut dyn Stage> = Vec::new();
        stages.extend(slide.as_mut().map(|stage| stage as &mut dyn Stage));
        stages.extend(target_field.as_mut().map(|stage| stage as &mut dyn Stage));
        stages
    }

    /// Overwrites the points of vertices that slid, as normalized positions do not hold all digits of these points.
    pub(super) fn slide_into(&self, points: &mut [[f64; 2]]) {
        for (v, point) in self.slide.iter().flat_map(SlideStage::moved) {
            points[v as usize] = point;
        }
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

    /// Returns the result of sliding with the vertices at `points`, `None` if no vertex may slide.
    pub(super) fn slid(&self, points: &[[f64; 2]]) -> Option<Slid> {
        let slide = self.slide.as_ref()?;
        Some(slide.slid(self.mesh, self.topology, points))
    }
}
