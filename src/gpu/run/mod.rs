//! A run on a device: the dispatches of its sweeps and corrections.

mod dispatches;
mod engine;
mod fine;
mod levels;
mod pages;

pub(crate) use dispatches::Run;
pub use engine::GpuEngine;
pub(crate) use fine::GpuFine;
