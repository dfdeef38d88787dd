//! The connectivity of a mesh: consistent windings, stars, one-rings and boundary edges. Contains the exact predicates
//! for inverted and flat triangles, and the checks of meshes based on them.

mod boundary;
mod certify;
mod checks;
mod clamp;
mod connectivity;
mod corners;
mod crossings;
mod enclosed_area;
mod feasibility;
mod hanging;
mod nesting;
pub(crate) mod predicates;
mod sides;
mod stars;
mod turns;
mod winding;

pub use crate::error::{BadQuadrilateral, BadTriangle};
pub use boundary::signed_area;
pub(crate) use certify::certified;
pub use certify::certify;
pub use connectivity::{DetachedTopology, Topology};
pub(crate) use corners::Corners;
pub use crossings::Crossing;
pub(crate) use enclosed_area::EnclosedArea;
pub use hanging::HangingNode;
pub use predicates::infeasible;
pub(crate) use turns::overlapping_star;
