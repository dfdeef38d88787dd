//! Makes the [`Problem`] of the engines from a mesh: free vertices are colored and renumbered, positions normalized.

mod coloring;
mod curve;
mod prepare;
mod problem;
mod sizes;
mod smallest_last;

pub use coloring::Coloring;
pub use prepare::prepare;
pub(crate) use prepare::prepare_to_slide;
pub use problem::Problem;
pub(crate) use sizes::target_areas;
pub use smallest_last::UNCOLORED;
