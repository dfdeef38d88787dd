//! The CPU engine: all cores, in double precision, four vertices at a time.

mod differences;
mod engine;
pub(crate) mod lanes;
mod newton;
mod objective;
mod patch;
mod secants;
mod sweep;
mod vcycle;

pub(crate) use engine::CpuEngine;
pub(crate) use newton::descent;
pub(crate) use objective::mean_excess;
pub(crate) use patch::points;
pub(crate) use sweep::held_back;
pub(crate) use vcycle::correction;
