//! Whole runs: sweeps on the engines that they need, then the improvement of the worst triangles. A run consists of
//! rounds if vertices slide, have a bound or an altitude to keep, or if targets belong to points of the plane.

pub(crate) mod altitude;
mod attempt;
#[cfg_attr(not(feature = "gpu"), path = "no_device.rs")]
mod device;
mod holding;
mod improving;
pub(crate) mod in_rounds;
mod limit;
mod places;
mod rounds;

pub(crate) use attempt::{Attempt, Ended};
pub(crate) use device::Device;
pub(crate) use improving::Improving;
pub(crate) use limit::Limit;
pub(crate) use places::Places;
pub(crate) use rounds::{Bound, Rounds};
