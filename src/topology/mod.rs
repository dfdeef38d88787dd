//! How the triangles of a mesh hang together: consistent windings, stars, one-rings and the boundary; exact
//! predicates on it, and what they certify.

mod boundary;
mod certify;
mod clamp;
mod connectivity;
pub(crate) mod predicates;
mod stars;
mod winding;

pub use boundary::signed_area;
pub use certify::certify;
pub use connectivity::Topology;
pub use predicates::infeasible;
