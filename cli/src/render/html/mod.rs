//! Pages in a single file, for `--html`: of a run, and of measured meshes.

mod charts;
mod edges;
mod mesh;
mod meshes;
mod overview;
mod page;
mod run;
mod tables;
mod worst;
mod write;

pub(crate) use meshes::{MeshDescription, MeshPart, PageEntry, write_meshes};
pub(crate) use overview::MeshNumbers;
pub(crate) use write::write;
