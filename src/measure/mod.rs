//! Quality measures of elements and edges: a table with a row per measure, values for a mesh, and statistics over its elements.

mod altitude;
mod change;
mod definition;
mod edges;
mod large_angles;
mod measured;
mod moments;
mod neighbors;
mod quadrilateral;
mod ranks;
mod search;
mod sizes;
mod statistics;
mod table;
mod triangle;
mod vertices;

pub(crate) use altitude::altitude;
pub(crate) use change::mean_edges;
pub use change::{Change, Distribution};
pub use definition::{Better, Definition, QuadrilateralDefinition};
pub use edges::InnerEdge;
pub(crate) use edges::inner_edges;
pub use large_angles::WhyLarge;
pub use measured::Measured;
pub use statistics::{QUANTILES, Statistics};
pub use table::{Measure, UnknownMeasure};
