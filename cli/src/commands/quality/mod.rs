//! The command `gpu-smooth quality MESH...`, which measures meshes.

mod bars;
mod command;
mod json;
mod mesh_quality;
mod text;
mod worst;

pub(crate) use command::run;
