//! `gpu-smooth MESH... --out-dir DIR`: smooths many meshes.

mod command;
mod entry;
mod listing;
mod table;
mod workers;

pub(crate) use command::run;
