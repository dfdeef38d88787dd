//! Mesh files: read once, written again with moved vertices and nothing else changed.

mod adcirc;
mod assemble;
mod binary;
mod compare;
mod detect;
mod families;
mod format;
mod freefem;
mod gmsh;
mod medit;
mod meditb;
mod mesh_file;
mod numbers;
mod obj;
mod off;
mod parallel_rows;
mod parsed;
mod ply;
mod regions;
mod replace;
mod rewrite;
mod selafin;
mod sink;
mod sms;
mod source;
mod su2;
mod tags;
mod text;
mod triangle;
mod vtk;
mod vtu;

pub use compare::Difference;
pub use format::Format;
pub use mesh_file::{MeshFile, Place};
pub use replace::{AbandonedWrites, abandon_writes, check, replace, same_file};
