//! Mesh files: read once, written again with moved vertices and nothing else changed.

mod binary;
mod detect;
mod format;
mod gmsh;
mod mesh_file;
mod parallel_rows;
mod parsed;
mod regions;
mod replace;
mod rewrite;
mod source;
mod text;
mod triangle;

pub use format::Format;
pub use mesh_file::{MeshFile, Place};
pub use replace::{AbandonedWrites, abandon_writes, check, replace, same_file};
