//! Whole runs: sweeps on whatever engines they take, in rounds where vertices slide, have a bound or an altitude to keep, or where
//! targets belong to places, and what is done to the worst triangles after that.

pub(crate) mod altitude;
mod attempt;
mod holding;
mod improving;
pub(crate) mod in_rounds;
mod limit;
mod places;
mod rounds;

pub(crate) use attempt::{Attempt, Ended};
pub(crate) use improving::Improving;
pub(crate) use limit::Limit;
pub(crate) use places::Places;
pub(crate) use rounds::{Bound, Rounds};
