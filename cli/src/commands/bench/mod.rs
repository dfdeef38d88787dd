//! The command `gpu-smooth bench`, which measures the speed of sweeps on this machine.

mod baseline;
mod command;
mod kernels;
mod lattice;
mod machine;
mod rates;
mod report;
mod runs;
mod sweeps;

pub(crate) use command::run;
