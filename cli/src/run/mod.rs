//! The run on a mesh: its engine, its steps from file to file, and the proof of its result.

pub(crate) mod checkpoint;
pub(crate) mod driver_probe;
pub(crate) mod engine;
pub(crate) mod observer;
pub(crate) mod proof;
pub(crate) mod task;
mod untangle;
