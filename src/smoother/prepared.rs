//! A prepared mesh: topology, layout, targets and curves, which serve any number of runs.

use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use glam::DVec2;
use web_time::Instant;

use crate::cpu::objective;
use crate::error::{MeshError, SmoothError};
use crate::layers::{Elements, KeepLayers, Layers};
use crate::layout::{Mercator, Problem, laid_out, prepare_to_slide};
use crate::mesh::{Element, Mesh, MeshSize};
use crate::metric::Metric;
use crate::options::{Guard, Options};
use crate::parallel::pace::now;
use crate::plane::{Plane, Storage};
use crate::slide::{OnCurves, Slide, Sliding};
use crate::targets::{OutsideReport, Surface, TargetField, Targets};
use crate::topology::{Topology, certified};
use crate::whole::altitude::least_of;
use crate::whole::{radii, set_targets_of};

use super::slivers;

/// A mesh prepared for smoothing: its topology, coloring and layout. Serves any number of runs. A clone shares the layout.
#[derive(Clone)]
pub struct Smoother<'a> {
    pub(super) mesh: Cow<'a, Mesh>,
    pub(super) topology: Topology<'a>,
    pub(super) problem: Problem,
    /// The curves that the caller set, for the fingerprint in checkpoints; `None` if no vertex slides.
    pub(super) slide: Option<Slide>,
    pub(super) sliding: Option<Arc<Sliding>>,
    /// The boundary layers that runs keep.
    layers: Layers,
    /// Whether all free vertices are in boundary layers. Runs then have no sweeps, and no vertex is fixed or slides.
    pub(super) is_all_kept: bool,
    /// Number of periodic pairs that slide, and number of pairs that stay because the common motion does not fit them.
    pairs: [usize; 2],
    /// Number of pairs of vertices at one place that slide, and number of further vertices of curves at the place of
    /// another, which stay.
    coincident: [usize; 2],
    /// Field of targets that belong to points of the plane; `None` if targets belong to vertices or are not set.
    pub(super) field: Option<TargetField>,
    /// Smoother of the mesh with opened [slivers], in the projection of the sphere. Serves the runs for which
    /// [`serving`](Self::serving) returns it, while the fields above serve all other runs. `None` unless the
    /// projection would invert slivers.
    pub(super) opened: Option<Box<Smoother<'static>>>,
    /// The plane of space in which the vertices lie; `None` for the plane of x and y.
    pub(super) plane: Option<Plane>,
    pub(super) prepare: Duration,
}

impl fmt::Debug for Smoother<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (MeshSize { vertices, triangles }, free) = (self.size(), self.problem.free_count());
        let mut debug = f.debug_struct("Smoother");
        debug.field("vertices", &vertices).field("triangles", &triangles).field("free", &free);
        debug.finish_non_exhaustive()
    }
}

impl Smoother<'static> {
    /// Prepares a mesh, and keeps the mesh in the smoother, which borrows nothing. Equal to [`Smoother::new`] otherwise.
    ///
    /// # Errors
    /// [`MeshError`] under the conditions of [`Smoother::new`].
    pub fn from_mesh(mesh: Mesh) -> Result<Self, MeshError> {
        Self::keeping_found(Cow::Owned(mesh))
    }
}

impl<'a> Smoother<'a> {
    /// Prepares a mesh. A mesh without free vertices, such as a strip of triangles, is accepted, as its vertices can
    /// slide; see [`set_slide`](Self::set_slide).
    ///
    /// Runs keep the boundary layers that [`KeepLayers::Auto`] finds above the boundary, as if [`Mesh::fixed`] listed their
    /// vertices. [`Self::keeping`] keeps other layers, or none.
    ///
    /// # Errors
    /// [`MeshError`] if the mesh cannot be smoothed: see [`Topology::new`] and [`Topology::check_smoothable`].
    pub fn new(mesh: &'a Mesh) -> Result<Self, MeshError> {
        Self::keeping_found(Cow::Borrowed(mesh))
    }

    fn keeping_found(mesh: Cow<'a, Mesh>) -> Result<Self, MeshError> {
        let start = Instant::now();
        let topology = topology_of(&mesh)?;
        let points = &mesh.points;
        let elements = Elements { topology: &topology, points, faces: &[], lines: &[] };
        let layers = KeepLayers::Auto.find(&elements, None)?;
        Self::of(mesh, topology, layers, start)
    }

    /// Prepares a mesh as [`Self::new`] does. Runs keep the given boundary layers, such as those of [`KeepLayers::find`] with
    /// walls inside the mesh, or none: `Layers::default()`. An application that moves walls keeps none, as vertices of
    /// layers would not follow the walls.
    ///
    /// If all free vertices are in layers, runs end before the first sweep, and no vertex moves.
    ///
    /// # Errors
    /// [`MeshError`] if the mesh cannot be smoothed, as for [`Self::new`], and [`MeshError::IndexOutOfRange`] if the layers
    /// have a vertex that does not exist.
    pub fn keeping(mesh: Cow<'a, Mesh>, layers: Layers) -> Result<Self, MeshError> {
        let start = Instant::now();
        let topology = topology_of(&mesh)?;
        Self::of(mesh, topology, layers, start)
    }

    /// Prepares a mesh as [`Self::keeping`] does, given the topology of the mesh, such as that in which a program has searched
    /// the layers.
    ///
    /// # Errors
    /// As for [`Self::keeping`].
    pub fn of_topology(
        mesh: &'a Mesh,
        topology: Topology<'a>,
        layers: Layers,
    ) -> Result<Self, MeshError> {
        Self::of(Cow::Borrowed(mesh), topology, layers, Instant::now())
    }

    fn of(
        mut mesh: Cow<'a, Mesh>,
        mut topology: Topology<'a>,
        layers: Layers,
        start: Instant,
    ) -> Result<Self, MeshError> {
        let is_all_kept = layers.have_all_free(&topology);
        let is_free = |&v: &u32| topology.free().get(v as usize).is_none_or(|&is_free| is_free);
        if !is_all_kept && layers.vertices.iter().any(is_free) {
            mesh.to_mut().fixed.extend_from_slice(&layers.vertices);
            topology = Topology::new(&mesh)?.into_owned();
        }
        let problem = prepare_to_slide(&mesh, &topology)?;
        // Runs need only the problem. The stars are computed again when a vertex has to be set back.
        topology.forget_stars();
        let (slide, sliding, field, opened) = (None, None, None, None);
        let (pairs, coincident) = ([0; 2], [0; 2]);
        Ok(Self {
            mesh,
            topology,
            problem,
            slide,
            sliding,
            layers,
            is_all_kept,
            pairs,
            coincident,
            field,
            opened,
            plane: None,
            prepare: start.elapsed(),
        })
    }

    /// Fails with [`MeshError::NothingFree`] if no vertex is free and no vertex slides.
    pub(super) fn check_movable(&self) -> Result<(), MeshError> {
        match self.problem.free_count() == 0 && self.sliding.is_none() {
            true => Err(MeshError::NothingFree { vertices: self.mesh.points.len() }),
            false => Ok(()),
        }
    }

    /// Returns the mesh that the smoother has prepared. The fixed vertices of the mesh include those of kept
    /// [layers](Self::layers).
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Returns the boundary layers that runs keep; see [`Self::keeping`].
    pub fn layers(&self) -> &Layers {
        &self.layers
    }

    /// Copies the mesh into the smoother, which then borrows nothing and can be stored in a struct without lifetimes,
    /// or moved into a spawned task. [`Self::from_mesh`] takes a mesh without a copy.
    pub fn into_owned(self) -> Smoother<'static> {
        Smoother {
            mesh: Cow::Owned(self.mesh.into_owned()),
            topology: self.topology.into_owned(),
            problem: self.problem,
            slide: self.slide,
            sliding: self.sliding,
            layers: self.layers,
            is_all_kept: self.is_all_kept,
            pairs: self.pairs,
            coincident: self.coincident,
            field: self.field,
            opened: self.opened,
            plane: self.plane,
            prepare: self.prepare,
        }
    }

    /// Lets further runs move the vertices of a mesh of longitudes and latitudes, in degrees, in the Mercator projection,
    /// so that f is that of the triangles on the sphere wherever the vertices move. Runs still take and return longitudes
    /// and latitudes, and no triangle is inverted in these coordinates. Distances, altitudes and curves of a run are measured
    /// in these coordinates too. Removes the targets and the sliding vertices: set both afterwards, targets as lengths in
    /// these coordinates ([`Targets::seen_on`], [`TargetField::seen_on`]).
    ///
    /// Slivers may be inverted or flat in the projection, as straight edges have curved images. Runs on a mesh with such
    /// slivers begin with the vertices near the slivers moved until the projection inverts no triangle. Returns false, and
    /// changes nothing, if no such positions are found. Then all runs move the vertices in longitude and latitude, as do runs on a mesh with such
    /// slivers that compare positions or triangles with the given mesh, by [`Options::max_move`],
    /// [`Options::keep_altitude`] or [`Guard::Worst`].
    ///
    /// # Errors
    /// [`MeshError::Latitude`] if a vertex is not on the sphere.
    pub fn project_from_sphere(&mut self) -> Result<bool, MeshError> {
        Surface::Sphere.check(&self.mesh.points, self.topology.corners())?;
        if let Some((projection, projected)) = Mercator::of(&self.mesh, &self.topology) {
            self.problem = laid_out(&projected, &self.topology).with_projection(projection);
            self.stop_sliding();
            self.field = None;
            return Ok(true);
        }
        let Some(opened) = slivers::opened(&self.mesh, &self.topology) else { return Ok(false) };
        let mut opened = Smoother::keeping(Cow::Owned(opened), Layers::default())?;
        // The vertices of the layers are fixed in the mesh, but on curves they would slide.
        (opened.layers, opened.is_all_kept) = (self.layers.clone(), self.is_all_kept);
        opened.project_from_sphere()?;
        self.problem = laid_out(&self.mesh, &self.topology);
        self.stop_sliding();
        self.field = None;
        self.opened = Some(Box::new(opened));
        Ok(true)
    }

    /// Returns the smoother that serves a run with the given options.
    pub(super) fn serving(&self, options: &Options) -> &Smoother<'_> {
        let is_compared =
            options.max_move.is_some() || options.keep_altitude || options.guard == Guard::Worst;
        match &self.opened {
            Some(opened) if !is_compared => opened,
            _ => self,
        }
    }

    /// Sets the targets of elements in further runs, one target per vertex of the mesh. Without targets, elements are
    /// to be equilateral triangles of equal size. f is then evaluated after the target maps are applied to the
    /// triangles.
    ///
    /// # Errors
    /// [`MeshError::ValueCount`] if `targets` does not have one target per vertex.
    pub fn set_targets(&mut self, targets: &Targets) -> Result<(), MeshError> {
        targets.check_count(self.mesh.points.len())?;
        let converted = self.problem.converted(targets, &self.mesh.points);
        self.problem.set_targets(&converted);
        self.field = None;
        if let Some(opened) = &mut self.opened {
            let converted = opened.problem.converted(targets, &self.mesh.points);
            opened.problem.set_targets(&converted);
            opened.field = None;
        }
        Ok(())
    }

    /// Sets the targets of elements at each point of the plane, in place of targets that belong to vertices. Returns a
    /// summary of the vertices outside of the field's background.
    ///
    /// A run then consists of periods of sweeps. At the end of each period, targets are evaluated at the new positions
    /// of the vertices, and f with these targets, which does not rise from period to period. Targets do not change
    /// within a period, so a run may end above the least possible f, when further periods do not lower f.
    ///
    /// # Errors
    /// [`MeshError::NotFinite`] if a coordinate of a vertex is infinite or NaN.
    pub fn set_target_field(&mut self, field: TargetField) -> Result<OutsideReport, MeshError> {
        let (targets, outside) = field.at(&self.mesh.points)?;
        self.set_targets(&targets)?;
        if let Some(opened) = &mut self.opened {
            opened.set_target_field(field.clone())?;
        }
        self.field = Some(field);
        Ok(outside)
    }

    /// Returns the form in which the positions of a run with these options are stored.
    pub(super) fn storage(&self, options: &Options) -> Storage<'_> {
        Storage::new(options.stored, self.plane.as_ref())
    }

    /// Lets vertices slide along the boundary and other curves in further runs; `None` turns sliding off. Vertices of kept
    /// [layers](Self::layers) do not slide. Returns the number of vertices that may slide.
    ///
    /// # Errors
    /// [`SmoothError::Option`] if a number is outside its range, [`MeshError::IndexOutOfRange`] if a listed vertex does
    /// not exist.
    pub fn set_slide(&mut self, slide: Option<&Slide>) -> Result<usize, SmoothError> {
        self.stop_sliding();
        if let Some(opened) = &mut self.opened {
            opened.set_slide(slide)?;
        }
        let Some(slide) = slide else { return Ok(0) };
        let vertices = self.mesh.points.len();
        slide.check(vertices)?;
        if self.is_all_kept {
            return Ok(0);
        }
        let held = [&slide.held[..], &self.layers.vertices].concat();
        let slide = &Slide { held, ..slide.clone() };
        let sliding = Sliding::new(&self.mesh.points, &self.topology, slide);
        let sliding = sliding.numbered(&self.problem, vertices);
        self.topology.forget_stars();
        let count = sliding.count();
        (self.pairs, self.coincident) = (sliding.pairs(), sliding.coincident());
        self.sliding = (count > 0).then(|| Arc::new(sliding));
        self.slide = self.sliding.is_some().then(|| slide.clone());
        Ok(count)
    }

    /// Returns whether vertices slide in runs; see [`Self::set_slide`].
    pub fn slides(&self) -> bool {
        self.sliding.is_some()
    }

    /// Returns whether runs are on the CPU, whatever their backend is, because vertices slide in the projection of a sphere, or
    /// because vertices slide and no vertex is free.
    pub fn stays_on_cpu(&self) -> bool {
        // Single precision has too few digits for curves in a projection.
        let slides_on_cpu = self.problem.is_projected() || self.problem.free_count() == 0;
        self.slides() && slides_on_cpu
    }

    pub(super) fn stop_sliding(&mut self) {
        (self.slide, self.sliding) = (None, None);
        (self.pairs, self.coincident) = ([0; 2], [0; 2]);
    }

    /// Returns the number of vertex pairs ([`Slide::periodic`]) that slide, and the number of pairs that stay. A pair
    /// stays if the translation or rotation of most pairs in its list does not fit the pair.
    pub fn pairs(&self) -> [usize; 2] {
        self.pairs
    }

    /// Returns the objective f by a metric with the vertices at `points`, after target maps are applied if targets are
    /// set; see [`Self::set_targets`] and [`Self::set_target_field`]. In the projection of a sphere, f is that of the
    /// projected triangles, unless the projection inverts one.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex, [`MeshError::NotFinite`] if a point
    /// that needs a target has an infinite or NaN coordinate.
    pub fn f(&self, metric: Metric, points: &[[f64; 2]]) -> Result<f64, MeshError> {
        self.topology.check_count(points)?;
        if let Some(opened) = &self.opened {
            let (images, topology) = (opened.problem.images(points), &opened.topology);
            let are_feasible = topology.bad_triangles(&images)?.is_empty()
                && topology.bad_quadrilaterals(&images)?.is_empty();
            if are_feasible {
                return opened.f(metric, points);
            }
        }
        let positions = now(self.problem.normalized(points, Vec::new()));
        let Some(field) = &self.field else {
            return Ok(now(objective(metric, &self.problem, &positions)));
        };
        let mut problem = self.problem.clone();
        set_targets_of(field, &self.mesh, &mut problem, &positions)?;
        Ok(now(objective(metric, &problem, &positions)))
    }

    /// Returns the number of pairs of vertices with equal coordinates that slide together, as on both sides of a crack, and
    /// the number of further vertices of curves with the coordinates of another vertex. Further vertices stay:
    /// three or more share their coordinates, or one of two is a corner or an end of the crack.
    pub fn coincident(&self) -> [usize; 2] {
        self.coincident
    }

    /// Returns the topology of the mesh: windings, boundary and free vertices.
    pub fn topology(&self) -> &Topology<'a> {
        &self.topology
    }

    /// Returns the elements that are neither inverted nor flat, but whose inverse mean ratio overflows in double
    /// precision, computed from any of their corners. Such elements are too flat, or too small beside other
    /// elements. A mesh with such elements may be refused by runs by EDGE or by metrics with a barrier
    /// ([`MeshError::BeyondPrecision`]); [`Untangle`](crate::Untangle) opens those that have a free vertex.
    pub fn beyond_precision(&self) -> Vec<Element> {
        let beyond = now(self.problem.beyond_precision(self.problem.positions()));
        self.topology.elements(&self.problem.in_mesh(&beyond, &self.topology))
    }

    /// Returns the number of colors of the free vertices.
    pub fn colors(&self) -> usize {
        self.problem.colors().len()
    }

    /// Returns the time that [`Self::new`] took, or the latest [`Self::set_points`].
    pub fn prepare_time(&self) -> Duration {
        self.prepare
    }

    /// Returns the size of the mesh. Only vertices that some element uses are counted.
    pub fn size(&self) -> MeshSize {
        let corners = self.problem.corners();
        let triangles = corners.triangles().len() + 4 * corners.quadrilateral_count();
        MeshSize { vertices: self.problem.positions().len(), triangles }
    }

    /// Sets the vertices of inverted or flat triangles back to their positions in the mesh, in place, and returns the
    /// number of vertices set back; see [`topology::certify`](crate::topology::certify). Needed if `points` are rounded
    /// again after [`Self::run`]. If a vertex slides in a pair, both vertices of the pair are set back.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex; no vertex is then moved.
    pub fn certify(&self, points: &mut [[f64; 2]]) -> Result<usize, MeshError> {
        now(self.certified(points, None))
    }

    /// Does the work of [`Self::certify`], with pauses. If the form in which `points` are stored is known, also sets sliding vertices
    /// back whose move [`Slide::misplaced`] would not allow, such as those that passed a neighbor that was set back.
    pub(super) async fn certified(
        &self,
        points: &mut [[f64; 2]],
        stored: Option<Storage<'_>>,
    ) -> Result<usize, MeshError> {
        let (before, topology) = (&self.mesh.points, &self.topology);
        let mut returned = certified(topology, before, points).await?;
        let Some(sliding) = &self.sliding else { return Ok(returned) };
        loop {
            match sliding.return_misplaced(before, points, stored) {
                0 => return Ok(returned),
                more => returned += more + certified(topology, before, points).await?,
            }
        }
    }

    /// Returns the sliding vertices at the start of a run, within the bounds of the options. `None` if no vertex slides.
    pub(super) fn on_curves(&self, options: &Options) -> Option<OnCurves> {
        let sliding = self.sliding.clone()?;
        let least_altitude = if options.keep_altitude { least_of(&self.problem) } else { 0.0 };
        let reach = options.max_move.map(|most| {
            let all = radii(&self.mesh, &self.topology, most, self.storage(options));
            sliding.for_each_vertex(|v| all[v as usize])
        });
        Some(OnCurves::new(sliding, reach, least_altitude))
    }

    /// Evaluates the field of targets with the vertices at normalized `positions`. Does nothing without a field.
    pub(super) fn set_targets_at(
        &self,
        problem: &mut Problem,
        positions: &[DVec2],
    ) -> Result<(), MeshError> {
        let set = |field| set_targets_of(field, &self.mesh, problem, positions);
        self.field.as_ref().map_or(Ok(()), set)
    }

    /// Returns the problem of a run, judged by the triangles with a corner that is free or slides. With a field of targets,
    /// the objective is the mean over all triangles: new targets also change the values of triangles that cannot move.
    pub(super) fn judged_problem(&self) -> Problem {
        if self.field.is_some() {
            return self.problem.clone();
        }
        let slides = self.sliding.as_deref().map(Sliding::vertices).unwrap_or_default();
        self.problem.judged_by_movable(&slides)
    }
}

/// Returns the topology of a mesh, which borrows the triangles of a borrowed mesh.
fn topology_of<'a>(mesh: &Cow<'a, Mesh>) -> Result<Topology<'a>, MeshError> {
    match mesh {
        Cow::Borrowed(mesh) => Topology::new(mesh),
        Cow::Owned(mesh) => Ok(Topology::new(mesh)?.into_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smoother_that_keeps_its_mesh_runs_as_one_that_borrows_the_mesh() {
        let points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.3, 0.6]];
        // The second triangle is wound clockwise.
        let triangles = vec![[0, 1, 4], [2, 1, 4], [2, 3, 4], [3, 0, 4]];
        let mesh = Mesh { points, triangles, ..Mesh::default() };
        let kept = Smoother::from_mesh(mesh.clone()).unwrap();
        assert_eq!(kept.mesh(), &mesh);
        let borrowed = Smoother::new(&mesh).unwrap();
        assert_eq!(kept.topology().triangles(), borrowed.topology().triangles());
        let run = |smoother: &Smoother<'_>| smoother.run(&Options::default()).block().unwrap();
        assert_eq!(run(&kept).points, run(&borrowed).points);
        let flat = Mesh { points: vec![[0.0; 2]; 5], ..mesh };
        Smoother::from_mesh(flat).unwrap_err();
        let expected = "Smoother { vertices: 5, triangles: 4, free: 1, .. }";
        assert_eq!(format!("{kept:?}"), expected);
    }
}
