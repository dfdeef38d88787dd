//! A mesh file that is prepared for smoothing, and the smoothed mesh.

use std::borrow::Cow;
use std::path::Path;

use gpu_smooth::layers::{Elements, KeepLayers, Layers};
use gpu_smooth::plane::Plane;
use gpu_smooth::precision::Precision;
use gpu_smooth::{Backend, Mesh, MeshError, Options, Outcome, SmoothError, Smoother, Topology};
use mesh_io::MeshFile;

use crate::domain::Domain;
use crate::error::JobError;
use crate::plane::{plane_of_file, z_field};
use crate::precision::smoother_precision;

/// A mesh file that is prepared for smoothing. Vertices that the file constrains and vertices between regions are fixed,
/// boundary layers stay ([`Job::keep_layers`]), a mesh in another plane than that of x and y is laid out in its plane, and no triangle is inverted by the digits that
/// the file has for a coordinate.
pub struct Job<'f> {
    file: &'f MeshFile,
    domain: Domain,
    /// The plane of the mesh; `None` if the mesh has no third coordinates, or equal ones.
    plane: Option<Plane>,
    keep_layers: KeepLayers,
}

impl<'f> Job<'f> {
    /// Prepares the mesh of a file.
    ///
    /// # Errors
    /// [`JobError::Plane`] if the vertices have third coordinates and do not lie in one plane.
    pub fn of_file(file: &'f MeshFile) -> Result<Self, JobError> {
        let (mut domain, plane) = (Domain::of_file(file), plane_of_file(file)?);
        if let Some(plane) = &plane {
            domain.mesh.points = plane.points().to_vec();
        }
        Ok(Self { file, domain, plane, keep_layers: KeepLayers::Auto })
    }

    /// Chooses the boundary layers whose vertices stay; by default [`KeepLayers::Auto`]. Walls are the boundary, the lines of
    /// the file, and edges between regions. Quadrilaterals of the file are elements of layers too.
    pub fn keep_layers(self, keep_layers: KeepLayers) -> Self {
        Self { keep_layers, ..self }
    }

    /// Finds the boundary layers whose vertices stay.
    ///
    /// # Errors
    /// [`MeshError`] if the mesh cannot be smoothed; see [`Topology::new`].
    pub fn layers(&self) -> Result<Layers, MeshError> {
        let Self { file, domain, .. } = self;
        let topology = Topology::new(&domain.mesh)?;
        let faces: Vec<Vec<u32>> = file.other_faces().map(<[u32]>::to_vec).collect();
        let lines = [file.constraints().lines.clone(), file.interface_edges()].concat();
        let points = &domain.mesh.points;
        let elements = Elements { topology: &topology, points, faces: &faces, lines: &lines };
        self.keep_layers.find(&elements, None)
    }

    /// Returns the mesh to smooth, with the vertices that the file fixes. Points are x and y of the file, or positions in the plane of
    /// the mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.domain.mesh
    }

    /// Returns the mesh to smooth, as [`mesh`](Self::mesh) does, for an application that keeps only the mesh.
    pub fn into_mesh(self) -> Mesh {
        self.domain.mesh
    }

    /// Returns the precision to which a run must round coordinates ([`Options::stored`]). Coordinates in a tilted plane
    /// are not stored, so a run does not round them.
    pub fn stored(&self) -> Precision {
        let of_file = || smoother_precision(self.file.precision());
        self.plane.as_ref().map_or_else(of_file, Plane::run_precision)
    }

    /// Smooths the mesh, and blocks until the run ends. The job replaces [`Options::stored`] by the precision of the
    /// file; all other options hold as given.
    ///
    /// # Errors
    /// [`JobError::Smooth`] if the mesh cannot be smoothed, an option is refused, or the device fails.
    pub fn smooth(self, options: &Options, backend: &Backend) -> Result<Smoothed<'f>, JobError> {
        let run = || -> Result<_, SmoothError> {
            let smoother = Smoother::keeping(Cow::Borrowed(self.mesh()), self.layers()?)?;
            let options = Options { stored: self.stored(), ..options.clone() };
            let mut outcome = smoother.run(&options).on(backend).block()?;
            if let Some(plane) = &self.plane {
                let before = &self.mesh().points;
                plane.certify_as_stored(smoother.topology(), before, &mut outcome.points)?;
            }
            Ok(outcome)
        };
        let path = || self.file.path().to_path_buf();
        let outcome = run().map_err(|error| JobError::Smooth { path: path(), error })?;
        Ok(Smoothed { job: self, outcome })
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
        let (Job { file, plane, .. }, points) = (&self.job, &self.outcome.points);
        let Some(plane) = plane.as_ref().filter(|plane| !plane.is_of_xy()) else {
            return Ok(file.write(path, points)?);
        };
        let xy: Vec<_> = plane.in_space(points).iter().map(|&[x, y, _]| [x, y]).collect();
        let z: Vec<_> = z_field(plane, file, points)?.into_iter().collect();
        Ok(file.write_with_fields(path, &xy, &z)?)
    }
}
