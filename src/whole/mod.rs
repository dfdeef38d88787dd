//! Whole runs: sweeps on whatever engines they take, in rounds where vertices slide, have a bound or an altitude to keep, or where
//! targets belong to places.

pub(crate) mod altitude;
mod attempt;
mod holding;
mod limit;
mod places;
mod rounds;

pub(crate) use attempt::Attempt;
pub(crate) use limit::Limit;
pub(crate) use places::Places;
pub(crate) use rounds::Rounds;
