//! The CPU engine: all cores, in double precision, four vertices at a time.

mod at_bound;
mod differences;
mod engine;
mod newton;
mod objective;
mod secants;
mod sweep;
mod vcycle;

pub(crate) use at_bound::steps_at_bound;
pub(crate) use engine::CpuEngine;
pub(crate) use objective::{mean_excess, mean_excess_left_out};
pub(crate) use sweep::held_back;
pub(crate) use vcycle::correction;
