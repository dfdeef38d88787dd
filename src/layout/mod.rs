//! Preparation of a mesh as the [`Problem`] of the engines: colors and renumbers the free vertices, and normalizes
//! positions.

mod bounds;
mod coloring;
mod conversion;
mod curve;
mod local_maps;
mod mercator;
mod normalization;
mod numbering;
mod placement;
mod prepare;
mod problem;
mod sizes;
mod smallest_last;

pub(crate) use bounds::Bounds;
pub use coloring::Coloring;
#[cfg(test)]
pub(crate) use curve::along_curve;
pub(crate) use mercator::{Mercator, MeshCoordinates};
pub(crate) use numbering::{DEGREE_BLOCK, OPPOSITE};
pub use prepare::prepare;
pub(crate) use prepare::{laid_out, prepare_to_slide};
#[cfg(feature = "gpu")]
pub(crate) use prepare::{prepare_like, prepare_to_untangle};
pub(crate) use problem::CornerPart;
#[cfg(feature = "gpu")]
pub(crate) use problem::MapKind;
pub use problem::Problem;
pub(crate) use sizes::target_areas;
pub use smallest_last::UNCOLORED;
