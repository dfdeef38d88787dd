//! The patch of a vertex: the triangles that depend on its position, one Newton step with its line search, and the rules
//! of all searches side by side. The code is generic over `f64` and SIMD lanes, in which four vertices are visited at
//! once.

mod acceptance;
mod batch;
mod corners;
mod direction;
mod fan;
pub(crate) mod instructions;
pub(crate) mod lanes;
mod mixed_ring;
mod newton_step;
pub(crate) mod numbers;
mod ring;
mod role;
pub(crate) mod search_rule;
mod sums;
#[cfg(test)]
mod tests;
mod triangles;

pub(crate) use acceptance::{
    AT_DISC, Circle, GROWTH, MIN_CIRCLE_CURVATURE, is_kept, is_no_worse, is_positive, is_within,
    keeps_altitude,
};
pub(crate) use batch::{VertexBatch, batch_at, batches};
#[cfg(test)]
pub(crate) use corners::Corners;
pub(crate) use corners::{MetricObjective, is_acceptable};
pub(crate) use direction::Direction;
#[cfg(test)]
pub(crate) use direction::newton_direction;
pub(crate) use fan::{Fan, FanCorner, FanPatch};
pub(crate) use mixed_ring::{MixedRings, MixedScratch};
pub(crate) use newton_step::{Objective, newton_step, step_alone};
pub(crate) use ring::{LanePatch, Rings, Scratch};
pub(crate) use role::{AroundVertex, Role};
pub(crate) use search_rule::SearchRule;
pub(crate) use sums::{Sums, from_lane};
pub(crate) use triangles::{FourTriangles, dot};
