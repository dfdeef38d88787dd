//! The quality metrics: a table with a row per metric, the invariants and dual numbers in their formulas, and schemes
//! of several metrics.

mod acute;
mod acute_size;
mod angles;
mod ar;
mod area;
mod corner;
mod curvature;
mod dual;
mod edge;
mod edge_slopes;
mod hinge;
mod imr;
pub(crate) mod opposite_angles;
mod properties;
mod rms;
mod scheme;
mod shape_and_size;
mod shape_size;
mod slopes;
pub(crate) mod smoothing;
mod soft_size;
mod table;
mod target;
mod tmop_2;
mod tmop_80;
mod tmop_94;

#[doc(hidden)]
pub use corner::Invariants;
pub(crate) use corner::of_right_angle;
pub use corner::{Corner, Ideal};
pub(crate) use curvature::{Curvature, Curved, H, OfImr};
#[doc(hidden)]
pub use dual::{Dual, Real};
pub(crate) use edge_slopes::{EdgeSlopes, Given, Own};
pub(crate) use hinge::Hinge;
#[doc(hidden)]
pub use properties::Properties;
pub use scheme::Scheme;
pub(crate) use smoothing::Smoothing;
pub(crate) use table::{Formulas, OfEdges, OfInvariants, with_each_metric};
pub use table::{Metric, UnknownMetric};
pub(crate) use target::TargetMap;
