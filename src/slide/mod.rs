//! Sliding vertices: vertices of the boundary and of lines inside the domain move along curves, from corner to corner.

mod banks;
mod chains;
mod clusters;
mod coincident;
mod corners;
mod curve;
mod edges;
mod movers;
mod newton;
mod on_curves;
mod options;
mod pairing;
mod params;
mod partners;
mod proof;
mod rigid;
mod side;
mod sliding;
mod track;
mod way;

pub use crate::periodic::{Motion, Periodic};
pub(crate) use newton::OfPatch;
pub(crate) use on_curves::{OnCurves, Tangents};
pub use options::Slide;
pub(crate) use params::Params;
pub(crate) use sliding::Sliding;
