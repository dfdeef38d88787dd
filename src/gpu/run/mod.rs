//! A run on a device: the dispatches of its sweeps and corrections.

mod ahead;
mod dispatches;
mod engine;
mod level_list;
mod levels;
mod listing;
mod pages;
mod secants;
mod slides;
pub(crate) mod stiffness;
#[cfg(test)]
mod sums_tests;
#[cfg(test)]
mod tests;
mod truncated;

pub(crate) use dispatches::Dispatches;
pub(crate) use engine::GpuEngine;
pub(crate) use levels::{Fitting, Levels};
