//! Mesh files: read once, written again with moved vertices and nothing else changed.

mod binary;
mod detect;
mod elided_rows;
mod gmsh;
mod mesh_file;
mod parallel_rows;
mod replace;
mod rewrite;
mod row_form;
mod source;
mod text;
mod triangle;

pub use mesh_file::{Format, MeshFile, Place};
pub use replace::{AbandonedWrites, abandon_writes, check, replace, same_file};
