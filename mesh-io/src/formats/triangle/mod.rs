//! Meshes of the mesh generator Triangle, in files that end in `.node`, `.ele` and `.poly`.

pub(crate) mod files;
pub(crate) mod names;
mod read;
mod rows;
mod segments;
pub(crate) mod write;

pub(crate) use read::Triangle;
