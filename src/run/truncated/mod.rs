//! The control of Newton steps of all vertices: without an engine, and the same for all engines.

mod bound;
mod search;
mod step;
mod tail;

pub(crate) use bound::ErrorBound;
pub(crate) use search::StepSearch;
pub(crate) use step::{NewtonStep, StepRequest};
pub(crate) use tail::Tail;
