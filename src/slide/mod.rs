//! Sliding vertices: vertices of the boundary and of lines inside the domain move along curves, from corner to corner.

mod acceleration;
mod banks;
mod chains;
mod coincident;
mod corners;
mod curve;
mod edges;
mod movers;
mod newton;
mod options;
mod pairing;
mod params;
mod partners;
mod proof;
mod rigid;
mod side;
mod sliding;
mod track;

pub use crate::periodic::{Motion, Periodic};
pub(crate) use acceleration::Acceleration;
pub(crate) use newton::Rule;
pub use options::Slide;
pub(crate) use params::{Params, read_params, write_params};
pub(crate) use sliding::Sliding;
