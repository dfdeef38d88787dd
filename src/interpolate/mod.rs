//! Data of vertices taken from a mesh at other places: linear in the triangles of the mesh.

mod background;
mod interpolation;
mod locate;

pub(crate) use background::{Background, Spot};
pub use interpolation::Interpolation;
