//! The CPU engine: all cores, in double precision, four vertices at a time.

mod along;
mod differences;
mod disc_tangents;
mod engine;
mod newton;
mod objective;
mod secants;
mod sweep;
mod truncated;
mod vcycle;
mod within;

pub(crate) use engine::CpuEngine;
#[cfg(feature = "gpu")]
pub(crate) use engine::remaining;
pub(crate) use objective::{mean_excess, mean_excess_left_out, objective, objectives};
pub(crate) use sweep::held_back;
pub(crate) use vcycle::correction;
