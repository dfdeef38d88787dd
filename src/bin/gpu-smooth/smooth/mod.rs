//! `gpu-smooth IN OUT`: a mesh is read, prepared, smoothed and written.

mod args;
mod destinations;
mod single;
mod task;

pub(crate) use args::{EngineChoice, SmoothArgs};
pub(crate) use destinations::check_report;
pub(crate) use single::run;
pub(crate) use task::{Done, Failure, Follow, Task, carry_out};
