//! The command `gpu-smooth IN OUT`, which smooths one mesh.

mod single;

pub(crate) use single::run;
