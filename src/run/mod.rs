//! The control of a run: options, the steps of a plan, the stop rule, and the loop over sweeps. Computing is left to
//! an [`Engine`], on the CPU or a device.

mod corrections;
mod drive;
mod engine;
mod history;
pub(crate) mod line_search;
pub(crate) mod multilevel;
mod objectives;
pub(crate) mod opening;
mod options;
mod plan;
pub(crate) mod secant;
mod shape_guard;
mod step;
mod stop;
mod sweeps;
mod yielding;

pub use drive::{Observer, Phase, Progress};
pub(crate) use drive::{Strategy, drive};
pub(crate) use engine::{Engine, Proposal};
pub(crate) use history::History;
pub use objectives::Objectives;
pub use options::{Desired, Goal, Method, Options};
pub use plan::Plan;
pub(crate) use shape_guard::shape_guard;
pub use step::{Derivatives, Sharpness, Step};
pub(crate) use stop::{JITTER, LEAST_SCALE, NOISE};
pub use stop::{Stop, StopRule};
pub use sweeps::Stepwise;
pub(crate) use sweeps::StepwiseRun;
