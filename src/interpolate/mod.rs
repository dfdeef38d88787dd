//! Data of vertices taken from a mesh at other places: linear in the triangles of the mesh.

mod interpolation;
mod locate;

pub use interpolation::Interpolation;
