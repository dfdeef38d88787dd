//! Pictures of a mesh colored by its quality, before and after a run, for `--picture`.

mod arrows;
mod canvas;
mod clip;
mod color;
mod draw;
mod faces;
mod font;
mod heading;
mod layout;
mod legend;
mod marks;
mod outlines;
mod png;
mod raster;
mod scene;
mod svg;

pub use color::{BAD, VIRIDIS};
pub(crate) use color::{NEUTRAL, PALE};
pub(crate) use draw::{MeshState, PictureSubject, picture_of, write};
pub(crate) use faces::FixedFaces;
pub(crate) use layout::Extent;
pub(crate) use outlines::{Outlines, slid};
