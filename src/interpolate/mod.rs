//! Interpolates data of vertices from a mesh, linearly in its triangles, at other points.

mod background;
mod interpolation;
mod locate;

pub use crate::chart::Chart;
pub(crate) use background::{Background, Spot};
pub use interpolation::Interpolation;
