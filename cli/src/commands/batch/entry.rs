//! How the smoothing of one of many meshes ended.

use std::path::PathBuf;

use crate::report::Failure;
use crate::report::Report;
use crate::terminal::numbers::five;

/// A mesh, and how its smoothing ended.
pub(crate) struct Entry {
    pub(crate) input: PathBuf,
    pub(crate) out: PathBuf,
    /// The files that are the mesh.
    pub(crate) files: Vec<PathBuf>,
    pub(crate) told: Told,
}

/// How the smoothing of a mesh ended.
pub(crate) enum Told {
    Smoothed {
        report: Box<Report>,
        remarks: Vec<String>,
    },
    /// The mesh was smoothed by an earlier call.
    Skipped,
    Failed(Failure),
    /// The user ended the call before the mesh was done.
    Interrupted,
}

impl Told {
    /// Returns the end in one word.
    pub(crate) fn status(&self) -> &'static str {
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

    /// Whether the run neither converged nor reached its goal.
    pub(crate) fn fell_short(&self) -> bool {
        self.report().is_some_and(|report| report.fell_short().is_some())
    }

    /// Describes the end in one line.
    pub(crate) fn text(&self) -> String {
        match (self.report(), self.problem()) {
            (Some(report), _) => {
                let (base, seconds) = (report.base(), report.seconds.total);
                let [before, after] = [&report.before, &report.after].map(|q| five(q.f[base]));
                let sweeps = report.sweeps;
                format!(
                    "{}, {sweeps} sweeps, f {base} {before} to {after}, {seconds:.2} s",
                    report.stop
                )
            }
            (None, Some(problem)) => problem,
            (None, None) => self.status().to_owned(),
        }
    }

    /// Returns the error without its list, if the mesh failed.
    pub(crate) fn problem(&self) -> Option<String> {
        match self {
            Self::Failed(failure) => Some(failure.error.headline()),
            _ => None,
        }
    }
}
