//! From a mesh to what the engines are given: free vertices colored, numbered anew and normalized.

mod coloring;
mod curve;
mod prepare;
mod problem;

pub use coloring::{Coloring, UNCOLORED};
pub use prepare::prepare;
pub use problem::Problem;
