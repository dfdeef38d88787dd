//! The patch of a vertex: the triangles that depend on its position, one Newton step with its line search, and the rules
//! of all searches side by side. The code is generic over `f64` and SIMD lanes, in which four vertices are visited at
//! once.

mod corners;
mod direction;
pub(crate) mod lanes;
mod newton_step;
mod numbers;
mod ring;
mod search_rule;

pub(crate) use corners::{Corners, MetricObjective, is_within};
pub(crate) use direction::{Direction, newton_direction};
pub(crate) use newton_step::{Objective, newton_step};
pub(crate) use numbers::{Mask, Numbers};
pub(crate) use ring::{Rings, Scratch};
pub(crate) use search_rule::{
    FLAT_EXPONENT, FLAT_RATIO, LEAST_FLAT, SUFFICIENT_DECREASE, SearchRule,
};
