//! A mesh that is to be smoothed, and the result of its run.

use std::path::Path;

use gpu_smooth::{Checkpoint, Outcome, Smoother};

use crate::error::CliError;
use crate::load::LoadedMesh;
use crate::load::explain::BadTriangleReport;
use crate::report::Report;
use crate::request::SmoothRequest;
use crate::terminal::Verbosity;

/// A mesh that is to be smoothed.
pub(crate) struct Task<'a> {
    pub(crate) request: &'a SmoothRequest,
    pub(crate) verbosity: Verbosity,
    pub(crate) input: &'a Path,
    pub(crate) out: &'a Path,
    /// The checkpoint that the run continues from, if there is one.
    pub(crate) resumed: Option<&'a Checkpoint>,
}

/// A mesh that was smoothed and written.
pub(crate) struct Done<'a> {
    pub(crate) file: &'a LoadedMesh,
    pub(crate) smoother: &'a Smoother<'a>,
    pub(crate) outcome: &'a Outcome,
    /// Pairs of a number of sweeps and the seconds of the run after which these sweeps were done.
    pub(crate) times: Vec<(u32, f64)>,
    pub(crate) report: Report,
}

/// The reason why a mesh was not smoothed.
pub(crate) struct Failure {
    pub(crate) error: CliError,
    /// All inverted and flat triangles in the order of the file, if they are the reason and a report was asked for;
    /// else empty.
    pub(crate) triangles: Vec<BadTriangleReport>,
}

impl From<CliError> for Failure {
    fn from(error: CliError) -> Self {
        Self { error, triangles: Vec::new() }
    }
}
