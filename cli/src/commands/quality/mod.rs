//! The command `gpu-smooth quality MESH...`, which measures meshes.

mod bars;
mod command;
mod json;
mod sheet;
mod text;

pub(crate) use command::run;
