//! Sliding vertices: vertices of the boundary and of lines inside the domain move along the curve that they are on,
//! from corner to corner.

mod acceleration;
mod chains;
mod curve;
mod newton;
mod options;
mod pairing;
mod partners;
mod rigid;
mod side;
mod sliding;

pub(crate) use acceleration::Acceleration;
pub(crate) use newton::Rule;
pub use options::Slide;
pub(crate) use sliding::{Params, Sliding};
