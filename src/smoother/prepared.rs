//! A prepared mesh: topology, layout, targets and curves, which serve any number of runs.

use std::borrow::Cow;
use std::time::Duration;

use glam::DVec2;
use web_time::Instant;

use crate::cpu::mean_excess;
use crate::error::{MeshError, SmoothError};
use crate::layout::{Problem, prepare_to_slide};
use crate::mesh::{Mesh, MeshSize};
use crate::metric::Metric;
use crate::slide::{Slide, Sliding};
use crate::targets::{Outside, TargetField, Targets};
use crate::topology::{Topology, certify};
use crate::whole::set_targets_of;

/// A mesh prepared for smoothing: its topology, coloring and layout. Serves any number of runs.
pub struct Smoother<'a> {
    pub(super) mesh: Cow<'a, Mesh>,
    pub(super) topology: Topology<'a>,
    pub(super) problem: Problem,
    /// The caller's curves, for the fingerprint in checkpoints.
    pub(super) slide: Option<Slide>,
    pub(super) sliding: Option<Sliding>,
    /// Number of periodic pairs that slide, and number of pairs that stay because the common motion does not fit them.
    pairs: [usize; 2],
    /// The field of targets, if targets belong to points of the plane and not to vertices.
    pub(super) field: Option<TargetField>,
    prepare: Duration,
}

impl<'a> Smoother<'a> {
    /// Prepares a mesh. A mesh without a free vertex, such as a strip of triangles, is accepted: its vertices can slide; see
    /// [`set_slide`](Self::set_slide).
    ///
    /// # Errors
    /// [`MeshError`] if the mesh cannot be smoothed: see [`Topology::new`] and [`Topology::check_smoothable`].
    pub fn new(mesh: &'a Mesh) -> Result<Self, MeshError> {
        let start = Instant::now();
        Ok(Self::of(mesh, prepare_to_slide(mesh)?, start))
    }

    fn of(mesh: &'a Mesh, prepared: (Topology<'a>, Problem), start: Instant) -> Self {
        let (mut topology, problem) = prepared;
        // Runs need only the problem. The stars are found again if a vertex has to be set back.
        topology.forget_stars();
        let (mesh, pairs) = (Cow::Borrowed(mesh), [0; 2]);
        let (slide, sliding, field) = (None, None, None);
        Self { mesh, topology, problem, slide, sliding, pairs, field, prepare: start.elapsed() }
    }

    /// Fails if no vertex is free and none slides.
    pub(super) fn check_movable(&self) -> Result<(), MeshError> {
        match self.problem.free_count() == 0 && self.sliding.is_none() {
            true => Err(MeshError::NothingFree { vertices: self.mesh.points.len() }),
            false => Ok(()),
        }
    }

    /// Copies the mesh into the smoother, which can then outlive the mesh that it was made from: in a struct without
    /// lifetimes, or in a spawned task.
    pub fn into_owned(self) -> Smoother<'static> {
        Smoother {
            mesh: Cow::Owned(self.mesh.into_owned()),
            topology: self.topology.into_owned(),
            problem: self.problem,
            slide: self.slide,
            sliding: self.sliding,
            pairs: self.pairs,
            field: self.field,
            prepare: self.prepare,
        }
    }

    /// Sets the targets of elements in further runs: one target for each vertex of the mesh, in place of equilateral
    /// triangles of one size. f is then that of the triangles after the target maps are applied.
    ///
    /// # Errors
    /// [`MeshError::ValueCount`] if there is not one target for each vertex.
    pub fn set_targets(&mut self, targets: &Targets) -> Result<(), MeshError> {
        targets.check_count(self.mesh.points.len())?;
        self.problem.set_targets(targets.maps());
        self.field = None;
        Ok(())
    }

    /// Sets the targets of elements at each point of the plane, in place of targets that belong to vertices. A run then
    /// consists of periods of sweeps, after each of which targets are evaluated at the new positions of the vertices. f
    /// is evaluated with these targets at the end of each period, and does not rise. Within a period targets do not
    /// change, so a run may end above the least possible f, when further periods do not lower it. Returns which vertices
    /// are outside of the field's mesh.
    ///
    /// # Errors
    /// [`MeshError::NotFinite`] if the position of a vertex is not finite.
    pub fn set_target_field(&mut self, field: TargetField) -> Result<Outside, MeshError> {
        let (targets, outside) = field.at(&self.mesh.points)?;
        self.set_targets(&targets)?;
        self.field = Some(field);
        Ok(outside)
    }

    /// Lets vertices slide along the boundary and other curves in further runs; `None` turns this off. Returns the
    /// number of vertices that may slide.
    ///
    /// # Errors
    /// [`SmoothError::Option`] if a number is out of its range, [`MeshError::IndexOutOfRange`] if a listed vertex does
    /// not exist.
    pub fn set_slide(&mut self, slide: Option<&Slide>) -> Result<usize, SmoothError> {
        (self.slide, self.sliding, self.pairs) = (None, None, [0; 2]);
        let Some(slide) = slide else { return Ok(0) };
        let vertices = self.mesh.points.len();
        slide.check(vertices)?;
        let sliding = Sliding::new(&self.mesh.points, &self.topology, slide);
        let sliding = sliding.numbered(&self.problem, vertices);
        self.topology.forget_stars();
        let count = sliding.count();
        self.pairs = sliding.pairs();
        self.sliding = (count > 0).then_some(sliding);
        self.slide = self.sliding.is_some().then(|| slide.clone());
        Ok(count)
    }

    /// Returns the number of pairs of vertices ([`Slide::periodic`]) that slide, and the number of pairs that do not
    /// move, as the translation or rotation of most pairs in their list does not fit them.
    pub fn pairs(&self) -> [usize; 2] {
        self.pairs
    }

    /// Returns the objective f by a metric with the vertices at `points`, after target maps are applied if there are
    /// any; see [`Self::set_targets`] and [`Self::set_target_field`].
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex, [`MeshError::NotFinite`] if a point at
    /// which a target is needed is not finite.
    pub fn f(&self, metric: Metric, points: &[[f64; 2]]) -> Result<f64, MeshError> {
        self.topology.check_count(points)?;
        let positions = self.problem.normalized(points, Vec::new());
        let Some(field) = &self.field else { return Ok(self.objective(metric, &positions)) };
        let mut problem = self.problem.clone();
        set_targets_of(field, &self.mesh, &mut problem, &positions)?;
        Ok(metric.ideal_squared() + mean_excess(metric, &problem, &positions))
    }

    /// Returns the mesh's topology: windings, boundary and free vertices.
    pub fn topology(&self) -> &Topology<'a> {
        &self.topology
    }

    /// Returns the triangles that are neither inverted nor flat, but so flat, or so small beside the others, that their
    /// inverse mean ratio is not finite as computed in double precision from one of their corners. With one of them a run by
    /// EDGE or a metric that has a barrier may be refused ([`MeshError::BeyondPrecision`]); [`untangle`](fn@crate::untangle) opens those that have a free vertex.
    pub fn beyond_precision(&self) -> Vec<usize> {
        let beyond = self.problem.beyond_precision(self.problem.positions());
        self.problem.in_mesh(&beyond, self.topology.triangles())
    }

    /// Returns the number of colors of the free vertices.
    pub fn colors(&self) -> usize {
        self.problem.colors().len()
    }

    /// Returns the duration of [`Self::new`].
    pub fn prepare_time(&self) -> Duration {
        self.prepare
    }

    /// Returns the number of triangles, and the number of vertices that some triangle uses.
    pub fn size(&self) -> MeshSize {
        let triangles = self.problem.triangles().len();
        MeshSize { vertices: self.problem.positions().len(), triangles }
    }

    /// Sets the vertices of inverted or flat triangles back to their positions in the mesh, in place, and returns the
    /// number of these vertices; see [`topology::certify`](crate::topology::certify). Needed if `points` are rounded
    /// again after [`Self::run`]. For pairs that slide, both vertices are set back.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex. Nothing is moved then.
    pub fn certify(&self, points: &mut [[f64; 2]]) -> Result<usize, MeshError> {
        let before = &self.mesh.points;
        let mut returned = certify(&self.topology, before, points)?;
        let Some(sliding) = &self.sliding else { return Ok(returned) };
        loop {
            match sliding.return_partners(before, points) {
                0 => return Ok(returned),
                more => returned += more + certify(&self.topology, before, points)?,
            }
        }
    }

    /// Returns the objective by a metric at normalized positions.
    pub(super) fn objective(&self, metric: Metric, positions: &[DVec2]) -> f64 {
        metric.ideal_squared() + mean_excess(metric, &self.problem, positions)
    }
}
