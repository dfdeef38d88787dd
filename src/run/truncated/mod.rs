//! The decisions about Newton steps of all vertices. Every engine follows the same decisions, and tests of the decisions need no
//! engine.

pub(crate) mod aggregation;
mod bound;
#[cfg(test)]
pub(crate) mod fixtures;
mod search;
mod step;
mod tail;

pub(crate) use bound::ErrorBound;
pub(crate) use search::StepSearch;
pub(crate) use step::{NewtonStep, StepRequest, could_gain};
pub(crate) use tail::Tail;
