//! A tried run with its result.

use crate::error::CliError;
use crate::report::Report;
use crate::request::TrialRun;

/// A tried run with its result.
pub(super) struct Tried<'a> {
    pub(super) run: &'a TrialRun,
    pub(super) result: Result<Report, CliError>,
}
