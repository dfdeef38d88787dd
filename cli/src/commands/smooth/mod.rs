//! The command `gpu-smooth IN OUT`, which smooths one mesh.

mod dry_run;
mod single;

pub(crate) use single::run;
