//! The command `gpu-smooth MESH... --out-dir DIR`, which smooths many meshes.

mod command;
mod entry;
mod listing;
mod table;
mod workers;

pub(crate) use command::run;
