//! From a mesh to the [`Problem`] of the engines: free vertices are colored and renumbered, positions normalized.

mod coloring;
mod curve;
mod prepare;
mod problem;
mod sizes;

pub use coloring::{Coloring, UNCOLORED};
pub use prepare::prepare;
pub use problem::Problem;
pub(crate) use sizes::target_areas;
