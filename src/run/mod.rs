//! All that decides: what a caller asks for, the steps of a plan, when a run ends, and the loop over sweeps.

mod drive;
mod engine;
pub(crate) mod multilevel;
mod opening;
mod options;
pub(crate) mod plan;

pub use drive::{Observer, Phase, Progress};
pub(crate) use drive::{Place, Run};
pub use engine::{Engine, Objectives};
pub use options::{Desired, Goal, Method, Options};
pub use plan::{Derivatives, Plan, Sharpness, Stop, StopRule};
