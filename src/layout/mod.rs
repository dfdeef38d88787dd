//! From a mesh to the [`Problem`] of the engines: free vertices are colored and renumbered, positions normalized.

mod coloring;
mod curve;
mod prepare;
mod problem;

pub use coloring::{Coloring, UNCOLORED};
pub use prepare::prepare;
pub use problem::Problem;
