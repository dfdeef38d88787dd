//! Runs on a mesh: engine, stages from input to output file, and proof of the result.

pub(crate) mod checkpoint;
pub(crate) mod driver_probe;
pub(crate) mod engine;
mod input;
pub(crate) mod observer;
mod pipeline;
mod prepare;
pub(crate) mod proof;
pub(crate) mod rehearsal;
mod result;
mod run_report;
mod spacing;
mod sweeps;
mod untangle;

pub(crate) use pipeline::run_pipeline;
