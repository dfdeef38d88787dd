//! `gpu-smooth IN OUT`: a run on one mesh.

mod single;

pub(crate) use single::run;
