//! A run on a device: the dispatches of its sweeps and corrections.

mod dispatches;
mod engine;
mod levels;
mod listing;
mod pages;
mod secants;
pub(crate) mod stiffness;
mod truncated;

pub(crate) use dispatches::Dispatches;
pub(crate) use engine::GpuEngine;
pub(crate) use levels::{Fitting, Levels};
