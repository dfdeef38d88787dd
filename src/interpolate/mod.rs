//! Interpolation of vertex data of a mesh at other points: linear within triangles, bilinear within quadrilaterals.

mod background;
mod element;
mod interpolation;
mod locate;

pub(crate) use background::{Background, Spot};
pub use interpolation::Interpolation;
