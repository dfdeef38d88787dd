//! The quality metrics: a table with a row for each, the invariants and dual numbers they are computed with, and
//! schemes of several metrics.

mod ar;
mod area;
mod corner;
mod dual;
mod edge;
mod imr;
mod properties;
mod rms;
mod scheme;
mod shape_size;
mod table;

pub use corner::{Corner, InvariantSlopes, Invariants, Slopes};
pub use dual::{Dual, Real};
pub use properties::Properties;
pub use scheme::Scheme;
pub(crate) use table::{AnyFormulas, Formulas, OfEdges, OfInvariants, with_each_metric};
// Other processors have one kind of lanes.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
pub(crate) use table::with_formulas;
pub use table::{Metric, UnknownMetric};
