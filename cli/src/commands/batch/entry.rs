//! The result for one mesh of a batch.

use std::path::PathBuf;

use crate::report::Failure;
use crate::report::Report;
use crate::terminal::numbers::fit8;

/// A mesh of a batch and its result.
pub(crate) struct Entry {
    pub(crate) input: PathBuf,
    pub(crate) out: PathBuf,
    /// The existing files of the mesh.
    pub(crate) files: Vec<PathBuf>,
    pub(crate) status: BatchStatus,
}

/// The result of smoothing one mesh.
pub(crate) enum BatchStatus {
    Smoothed {
        report: Box<Report>,
        remarks: Vec<String>,
    },
    /// An earlier command has smoothed the mesh.
    Skipped,
    Failed(Failure),
    /// A signal ended the command before the mesh was finished.
    Interrupted,
}

impl BatchStatus {
    /// Returns the result in one word.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Smoothed { .. } => "smoothed",
            Self::Skipped => "skipped",
            Self::Failed(_) => "failed",
            Self::Interrupted => "interrupted",
        }
    }

    pub(crate) fn report(&self) -> Option<&Report> {
        match self {
            Self::Smoothed { report, .. } => Some(report),
            _ => None,
        }
    }

    /// Returns whether the run neither converged nor reached its goal. False for meshes without a
    /// run.
    pub(crate) fn fell_short(&self) -> bool {
        self.report().is_some_and(|report| report.fell_short().is_some())
    }

    /// Describes the result in one line.
    pub(crate) fn text(&self) -> String {
        match (self.report(), self.problem()) {
            (Some(report), _) => {
                let (base, seconds) = (report.base(), report.seconds.total);
                let [before, after] = [&report.before, &report.after].map(|q| fit8(q.f[base]));
                let sweeps = report.sweeps;
                format!(
                    "{}, {sweeps} sweeps, f {base} {before} to {after}, {seconds:.2} s",
                    report.stop
                )
            }
            (None, Some(problem)) => problem,
            (None, None) => self.name().to_owned(),
        }
    }

    /// Returns the error of a failed mesh without details; `None` for other results.
    pub(crate) fn problem(&self) -> Option<String> {
        match self {
            Self::Failed(failure) => Some(failure.error.headline()),
            _ => None,
        }
    }
}
