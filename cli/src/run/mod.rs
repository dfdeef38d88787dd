//! The run on a mesh: its engine, its stages from file to file, and the proof of its result.

pub(crate) mod checkpoint;
pub(crate) mod driver_probe;
pub(crate) mod engine;
mod input;
pub(crate) mod observer;
mod pipeline;
mod prepare;
pub(crate) mod proof;
mod result;
mod run_report;
mod sweeps;
mod untangle;

pub(crate) use pipeline::carry_out;
