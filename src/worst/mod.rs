//! Improves the worst triangles after a run: free vertices around them move so that the worst triangle of each region
//! becomes less bad.

mod badness;
mod penalties;
mod region;
mod regions;
pub(crate) mod rounds;
mod shapes;
mod stage;

pub(crate) use badness::Badness;
pub(crate) use penalties::Penalties;
pub(crate) use region::{MoveConstraints, TriangleSet, sorted};
pub(crate) use regions::around;
pub(crate) use shapes::WorstShapes;
pub(crate) use stage::{Passes, stuck, worst_movable};
