//! The report of a run: its data, its certificate, and its summary in words.

mod certificate;
mod distinct;
mod floored;
mod histogram;
mod improved;
mod large_angles;
mod profile;
mod quantities;
mod reasons;
mod run;
mod spacing;
mod summary;
mod target;
mod task;
mod versioned;

pub(crate) use certificate::{Certificate, FileHash};
pub(crate) use distinct::DistinctMeasures;
pub(crate) use floored::FlooredReport;
pub(crate) use histogram::{Histogram, histogram};
pub(crate) use improved::ImprovedReport;
pub(crate) use large_angles::LargeAnglesReport;
pub(crate) use profile::{ProfileChange, ProfileReport, Verdict};
pub(crate) use quantities::{Finding, Quantities, Worst};
pub(crate) use run::{
    ChangeReport, EngineReport, FaultReport, GoalReport, MeshReport, QualityReport, Refusal,
    Report, Seconds, SlideReport, UntangleReport, history,
};
pub(crate) use spacing::{SpacingReport, spacing_change, spacing_sentences};
pub(crate) use summary::change_of;
pub(crate) use target::TargetReport;
pub(crate) use task::{Done, Failure, SmoothJob};
pub(crate) use versioned::versioned_json;
