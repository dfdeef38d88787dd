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
#[cfg(feature = "gpu")]
mod table;
mod track;
mod vertices;
mod way;

pub use crate::periodic::{Motion, Periodic};
pub(crate) use movers::Movers;
pub(crate) use newton::OfPatch;
#[cfg(feature = "gpu")]
pub(crate) use newton::{HALVINGS, MAX_STEP_SHARE};
#[cfg(feature = "gpu")]
pub(crate) use on_curves::FREEZES_AFTER;
pub(crate) use on_curves::{OnCurves, Tangents};
pub use options::Slide;
pub(crate) use params::Params;
pub(crate) use sliding::Sliding;
#[cfg(feature = "gpu")]
pub(crate) use table::{CurveTable, Knot, Place, SlidingVertex};
