//! Improves the worst triangles after a run: free vertices around them move so that the worst triangle of each patch
//! becomes less bad.

mod badness;
mod patch;
mod regions;
mod stage;

pub(crate) use badness::Badness;
pub(crate) use patch::Rules;
pub(crate) use stage::{improve, stuck, worst_movable};
