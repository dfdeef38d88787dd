//! Quantities of triangles, edges and vertices, and ranges of their bad values.

mod quantity;
mod threshold;

pub(crate) use quantity::{Part, Quantity};
pub(crate) use threshold::Threshold;
