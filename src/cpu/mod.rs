//! Where a run computes on the CPU: all cores, in double precision, four vertices at a time.

mod engine;
mod fine;
mod lanes;
mod newton;
mod objective;
mod patch;
mod sweep;
mod vcycle;

pub use engine::CpuEngine;
pub(crate) use fine::CpuFine;
pub(crate) use objective::mean_excess;
