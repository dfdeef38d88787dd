//! The quality metrics: one row each in the table, the numbers they are computed with, and schemes that alternate them.

mod dual;
mod scheme;
mod table;

pub use dual::{Dual, Real};
pub use scheme::Scheme;
pub(crate) use table::specialize;
pub use table::{Corner, Metric, Properties, Stiffness, UnknownMetric};
