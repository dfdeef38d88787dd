//! A mesh file that is prepared for smoothing, and the smoothed mesh.

use std::borrow::Cow;
use std::path::Path;

use gpu_smooth::front_ends::Plane;
use gpu_smooth::layers::{KeepLayers, Layers};
use gpu_smooth::options::Precision;
use gpu_smooth::targets::Surface;
use gpu_smooth::untangle::{Untangle, Untangled};
use gpu_smooth::{Backend, Mesh, MeshError, Options, Outcome, SmoothError, Smoother, Topology};
use mesh_io::MeshFile;

use crate::domain::{Domain, SlideBy};
use crate::error::JobError;
use crate::options::Settings;
use crate::plane::{plane_of_file, z_field};
use crate::precision::smoother_precision;
use crate::run::RunRequest;
use crate::target::TargetRequest;

/// A mesh file that is prepared for smoothing. Vertices that the file constrains and vertices between regions are fixed,
/// boundary layers stay ([`Job::keep_layers`]), a mesh in another plane than that of x and y is laid out in its plane, and no
/// triangle or quadrilateral is inverted by the digits that the file has for a coordinate. Vertices of quadrilaterals move
/// ([`Job::keep_quadrilaterals`]), also in files without triangles, which
/// [`allow_quadrilaterals_alone`](mesh_io::ReadOptions::allow_quadrilaterals_alone) reads. The command line does the same with
/// its options.
pub struct Job<'f> {
    file: &'f MeshFile,
    domain: Domain,
    keep_layers: KeepLayers,
    target: TargetRequest,
    slide: Option<SlideBy>,
    untangles: bool,
}

impl<'f> Job<'f> {
    /// Prepares the mesh of a file.
    ///
    /// # Errors
    /// [`JobError::Plane`] if the vertices have third coordinates and do not lie in one plane.
    pub fn of_file(file: &'f MeshFile) -> Result<Self, JobError> {
        let mut domain = Domain::of_elements(file);
        domain.set_plane(plane_of_file(file)?);
        Ok(Self::with(file, domain))
    }

    /// Prepares the mesh of a file in x and y. Third coordinates are data, such as the depth of water, and may be those of a
    /// curved surface.
    pub fn in_xy(file: &'f MeshFile) -> Self {
        Self::with(file, Domain::of_elements(file))
    }

    /// Prepares the mesh of a file whose x and y are longitude and latitude in degrees. Runs move vertices on the sphere, with
    /// lengths in degrees of latitude. Third coordinates are data.
    ///
    /// # Errors
    /// [`JobError::Smooth`] if a latitude is not from -90 to 90, or if a pole is inside an element or on an edge.
    pub fn on_sphere(file: &'f MeshFile) -> Result<Self, JobError> {
        let mut job = Self::with(file, Domain::of_elements(file));
        job.target.surface = Surface::Sphere;
        let stored = smoother_precision(file.precision());
        let laid_out = job.domain.lay_out_on_sphere(stored);
        laid_out.map_err(|error| job.error(error))?;
        Ok(job)
    }

    fn with(file: &'f MeshFile, domain: Domain) -> Self {
        let (keep_layers, target) = (KeepLayers::Auto, TargetRequest::default());
        Self { file, domain, keep_layers, target, slide: None, untangles: false }
    }

    /// Chooses the boundary layers whose vertices stay; by default [`KeepLayers::Auto`]. Walls are the boundary, the lines of
    /// the file, and edges between regions. Quadrilaterals of the file are elements of layers too.
    pub fn keep_layers(self, keep_layers: KeepLayers) -> Self {
        Self { keep_layers, ..self }
    }

    /// Chooses the desired shape and size of elements; by default equilateral, of any size. The surface of the request is
    /// ignored: the job has one.
    pub fn target(self, target: TargetRequest) -> Self {
        let surface = self.target.surface;
        Self { target: TargetRequest { surface, ..target }, ..self }
    }

    /// Lets the vertices of the boundary, of lines, and between regions slide along their lines. Ends of the groups of the file
    /// stay.
    pub fn slide(self, by: SlideBy) -> Self {
        Self { slide: Some(by), ..self }
    }

    /// Adds the options of the mesh by the words that the command line and the Python package share, such as `slide`. A target is
    /// set before its options. The options of the run are in [`Settings::run`], which [`options`](Self::options) takes; the
    /// surface is chosen by [`on_sphere`](Self::on_sphere), and the meaning of third coordinates by [`in_xy`](Self::in_xy).
    ///
    /// # Errors
    /// [`JobError::Smooth`] with `only-bad` if the mesh cannot be smoothed.
    pub fn settings(mut self, settings: &Settings) -> Result<Self, JobError> {
        if settings.frees_lines {
            self.domain.free_lines();
        }
        if let Some(limit) = settings.only_bad {
            let fixed = self.domain.fix_far_from_bad(limit, settings.rings_of_bad());
            fixed.map_err(|error| self.error(error))?;
        }
        let by = SlideBy::default();
        let corner_angle = settings.corner_angle.unwrap_or(by.corner_angle);
        let by = SlideBy { corner_angle, hausdorff: settings.hausdorff, ..by };
        let rings = settings.target_rings.or(self.target.rings);
        let of_places = settings.of_places.or(self.target.of_places);
        let target = TargetRequest { rings, of_places, ..self.target };
        let slide = if settings.slides { Some(by) } else { self.slide };
        Ok(Self { slide, target, untangles: self.untangles || settings.untangles, ..self })
    }

    /// Untangles the mesh before the run, if triangles are inverted or flat; see [`Untangle`].
    pub fn untangle(self) -> Self {
        Self { untangles: true, ..self }
    }

    /// Keeps all vertices of quadrilaterals where they are. Only triangles then move.
    pub fn keep_quadrilaterals(mut self) -> Self {
        self.domain.keep_quadrilaterals(self.file);
        self
    }

    /// Lets vertices between regions move, unless they are fixed for another reason.
    pub fn free_interfaces(mut self) -> Self {
        self.domain.free_interfaces();
        self
    }

    /// Fixes vertices, so that they neither move nor slide.
    ///
    /// # Errors
    /// [`JobError::Smooth`] if a vertex does not exist.
    pub fn fix(mut self, vertices: &[u32]) -> Result<Self, JobError> {
        let fixed = self.domain.fix(vertices);
        fixed.map_err(|error| self.error(error))?;
        Ok(self)
    }

    /// Fixes all vertices except `vertices`.
    ///
    /// # Errors
    /// [`JobError::Smooth`] if a vertex does not exist.
    pub fn fix_all_but(mut self, vertices: &[u32]) -> Result<Self, JobError> {
        let fixed = self.domain.fix_all_but(vertices);
        fixed.map_err(|error| self.error(error))?;
        Ok(self)
    }

    /// Finds the boundary layers whose vertices stay.
    ///
    /// # Errors
    /// [`MeshError`] if the mesh cannot be smoothed; see [`Topology::new`].
    pub fn layers(&self) -> Result<Layers, MeshError> {
        let Self { file, domain, .. } = self;
        let faces = domain.faces_beside_mesh(file);
        domain.layers(&Topology::new(domain.mesh())?, self.keep_layers, None, &faces)
    }

    /// Returns the mesh to smooth, with the vertices that the file fixes. Points are x and y of the file, or positions in the
    /// plane of the mesh.
    pub fn mesh(&self) -> &Mesh {
        self.domain.mesh()
    }

    /// Returns the mesh to smooth, as [`mesh`](Self::mesh) does, for an application that keeps only the mesh.
    pub fn into_mesh(mut self) -> Mesh {
        self.domain.take_mesh()
    }

    /// Returns the precision to which a run must round coordinates ([`Options::stored`]). Coordinates in a tilted plane
    /// are not stored, so a run does not round them.
    pub fn stored(&self) -> Precision {
        let of_file = || smoother_precision(self.file.precision());
        self.domain.plane().map_or_else(of_file, Plane::run_precision)
    }

    /// Returns the options of a run that leaves out what `request` leaves out. Without a scheme, the metric is that of the
    /// target: [`TargetKind::default_metric`](crate::TargetKind::default_metric).
    pub fn options(&self, request: &RunRequest) -> Options {
        request.options(self.target.kind.default_metric(), self.stored())
    }

    /// Smooths the mesh, and blocks until the run ends. The job replaces [`Options::stored`] by the precision of the
    /// file; all other options hold as given.
    ///
    /// # Errors
    /// [`JobError::Smooth`] if the mesh cannot be smoothed, an option is refused, or the device fails. [`JobError::Groups`] if
    /// vertices slide and the groups of the file cannot be read. [`JobError::Tangled`] if the mesh cannot be untangled.
    pub fn smooth(
        mut self,
        options: &Options,
        backend: &Backend,
    ) -> Result<Smoothed<'f>, JobError> {
        if self.untangles {
            self.untangle_now()?;
        }
        let target = std::mem::take(&mut self.target);
        let ends = match self.slide {
            Some(_) => self.file.group_ends()?,
            None => Vec::new(),
        };
        let run = || -> Result<_, SmoothError> {
            let mut smoother = Smoother::keeping(Cow::Borrowed(self.mesh()), self.layers()?)?;
            if target.surface == Surface::Sphere {
                smoother.project_from_sphere()?;
            }
            target.set(&mut smoother, self.domain.chart(), options.scheme.base())?;
            if let Some(by) = &self.slide {
                let by = SlideBy { ends: [&by.ends[..], &ends].concat(), ..by.clone() };
                let curves = self.domain.curves(&self.mesh().points, smoother.topology(), &by);
                smoother.set_slide(Some(&curves.slide))?;
            }
            let options = options.clone().stored(self.stored());
            if let Some(plane) = self.domain.plane() {
                smoother.set_plane(plane)?;
            }
            smoother.run(&options).on(backend).block()
        };
        let outcome = run().map_err(|error| self.error(error))?;
        Ok(Smoothed { job: self, outcome })
    }

    /// Untangles the mesh if it needs to be. Vertices of boundary layers stay.
    fn untangle_now(&mut self) -> Result<(), JobError> {
        let kept = match Topology::new(self.mesh()) {
            // The preparation of the run reports errors of the mesh.
            Err(_) => Vec::new(),
            Ok(topology) => {
                let layers = self.layers().map_err(|error| self.error(error))?;
                if layers.have_all_free(&topology) { Vec::new() } else { layers.vertices }
            }
        };
        if !kept.is_empty() {
            self.domain.fix(&kept).map_err(|error| self.error(error))?;
            self.keep_layers = KeepLayers::None;
        }
        let prepared = Smoother::keeping(Cow::Borrowed(self.mesh()), Layers::default());
        let is_tangled = match prepared {
            Ok(smoother) => {
                smoother.beyond_precision().iter().any(|&t| smoother.topology().can_move(t))
            }
            Err(MeshError::Infeasible { .. }) => true,
            Err(error) => return Err(self.error(error)),
        };
        if !is_tangled {
            return Ok(());
        }
        let untangle = Untangle::new(self.mesh()).in_plane(self.domain.plane());
        let done = untangle.stored(self.stored()).run();
        let done = done.map_err(|error| self.error(error))?;
        if !done.is_feasible() {
            let path = self.file.path().to_path_buf();
            let Untangled { left, left_quadrilaterals, .. } = done;
            return Err(JobError::Tangled { path, left, left_quadrilaterals });
        }
        self.domain.replace_points(done.points);
        Ok(())
    }

    /// Returns an error of the smoother with the path of the file.
    fn error(&self, error: impl Into<SmoothError>) -> JobError {
        JobError::Smooth { path: self.file.path().to_path_buf(), error: error.into() }
    }
}

/// The smoothed mesh of a [`Job`].
pub struct Smoothed<'f> {
    job: Job<'f>,
    outcome: Outcome,
}

impl<'f> Smoothed<'f> {
    /// Returns the outcome of the run. Points are in the coordinates of [`Job::mesh`].
    pub fn outcome(&self) -> &Outcome {
        &self.outcome
    }

    /// Returns the job, whose mesh has the points before the run.
    pub fn job(&self) -> &Job<'f> {
        &self.job
    }

    /// Writes the file with the vertices at their new positions. Only coordinates of moved vertices differ from the file
    /// that was read. No triangle of the written file is inverted or flat, by exact signs of its coordinates, if none
    /// was in the file that was read.
    ///
    /// # Errors
    /// [`JobError::Write`] if the file cannot be written, or [`JobError::Plane`] if the third coordinates cannot be read
    /// again.
    pub fn write(&self, path: &Path) -> Result<(), JobError> {
        let (Job { file, domain, .. }, points) = (&self.job, &self.outcome.points);
        let z = match domain.plane() {
            Some(plane) => z_field(plane, file, points)?,
            None => None,
        };
        Ok(file.write_with_fields(path, &domain.given(points), z.as_slice())?)
    }
}
