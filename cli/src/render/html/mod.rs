//! The page of a run in a single file, for `--html`.

mod charts;
mod mesh;
mod page;
mod run;
mod tables;
mod worst;
mod write;

pub(crate) use write::write;
