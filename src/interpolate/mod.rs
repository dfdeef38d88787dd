//! Interpolation of vertex data of a mesh, linear within its triangles, at other points.

mod background;
mod interpolation;
mod locate;

pub(crate) use background::{Background, Spot};
pub use interpolation::Interpolation;
