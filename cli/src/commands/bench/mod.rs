//! `gpu-smooth bench`: measures how fast this machine smooths.

mod baseline;
mod command;
mod kernels;
mod lattice;
mod machine;
mod rates;
mod report;
mod sweeps;

pub(crate) use command::run;
