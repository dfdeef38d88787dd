//! `gpu-smooth IN OUT`: a run on one mesh.

mod destinations;
mod single;

pub(crate) use destinations::check_report;
pub(crate) use single::run;
