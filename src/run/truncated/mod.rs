//! The decisions about Newton steps of all vertices. They are the same for all engines, and are tested without one.

mod bound;
mod search;
mod step;
mod tail;

pub(crate) use bound::ErrorBound;
pub(crate) use search::StepSearch;
pub(crate) use step::{NewtonStep, StepRequest};
pub(crate) use tail::Tail;
