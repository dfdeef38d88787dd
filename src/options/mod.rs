//! Options of a run, ranges of their numbers, and the table of mutually exclusive features.

mod conflicts;
mod error;
mod feature;
mod guard;
mod method;
mod norm;
mod ranges;
mod run_options;
mod stopping;
mod text;
mod worst_by;

pub use error::OptionError;
pub use feature::Feature;
pub use guard::Guard;
pub use method::{Derivatives, Method, Paper, Relaxed};
pub use norm::PNormExponent;
pub use ranges::OptionRange;
pub use run_options::Options;
pub use stopping::{Goal, Stopping};
pub use worst_by::WorstBy;

pub use crate::precision::{Precision, Rounding};
