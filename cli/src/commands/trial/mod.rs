//! The command `gpu-smooth try MESH`, which compares runs with several targets.

mod best;
mod command;
mod table;
mod tried;

pub(crate) use command::run;
