//! The task to smooth a mesh, and the result of its run.

use std::path::Path;

use gpu_smooth::{Checkpoint, Outcome, Smoother, topology::BadTriangle};

use crate::error::CliError;
use crate::load::LoadedMesh;
use crate::load::explain::{self, BadTriangleReport};
use crate::report::Report;
use crate::request::SmoothRequest;
use crate::terminal::Verbosity;

/// The task to smooth one mesh.
pub(crate) struct SmoothJob<'a> {
    pub(crate) request: &'a SmoothRequest,
    pub(crate) verbosity: Verbosity,
    pub(crate) input: &'a Path,
    pub(crate) out: &'a Path,
    /// The checkpoint from which the run continues; `None` for a new run.
    pub(crate) resumed: Option<&'a Checkpoint>,
}

/// The result for a mesh that was smoothed and written.
pub(crate) struct Done<'a> {
    pub(crate) file: &'a LoadedMesh,
    pub(crate) smoother: &'a Smoother<'a>,
    pub(crate) outcome: &'a Outcome,
    /// Pairs of a sweep's number and the run's elapsed seconds after that sweep.
    pub(crate) times: Vec<(u32, f64)>,
    pub(crate) report: Report,
}

/// An error that kept a mesh from being smoothed.
pub(crate) struct Failure {
    pub(crate) error: CliError,
    /// The inverted and flat triangles for the report, in the order of the file; `None` without a report. After a failed
    /// untangling, the list has the triangles that stay inverted or flat.
    pub(crate) triangles: Option<Vec<BadTriangleReport>>,
}

impl Failure {
    /// Returns the failure of a mesh for `triangles`, which are inverted or flat.
    pub(crate) fn of_triangles(
        request: &SmoothRequest,
        file: &LoadedMesh,
        error: CliError,
        triangles: &[BadTriangle],
    ) -> Self {
        let is_reported = request.outputs.report.is_some();
        Self { error, triangles: is_reported.then(|| explain::bad_triangles(file, triangles)) }
    }
}

impl From<CliError> for Failure {
    fn from(error: CliError) -> Self {
        Self { error, triangles: None }
    }
}
