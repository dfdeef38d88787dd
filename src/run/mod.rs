//! The control of a run: the plan with its steps, the stop rule, corrections, checkpoints, and the loop over sweeps. An
//! [`Engine`] computes the sweeps, on the CPU or a device.

mod checkpoint;
mod checkpoint_policy;
pub(crate) mod checksum;
pub(crate) mod corrections;
mod course;
mod engine;
mod history;
pub(crate) mod line_search;
pub(crate) mod multilevel;
mod named;
mod objectives;
pub(crate) mod opening;

mod plan;
mod progress;
pub(crate) mod records;
pub(crate) mod regularization;
mod saved;
pub(crate) mod secant;
mod shape_guard;
mod stop;
mod sweep_params;
mod sweeping;
pub(crate) mod sweeps;
pub(crate) mod truncated;
mod work;

pub use checkpoint::Checkpoint;
pub(crate) use checkpoint::RunFingerprint;
pub use checkpoint_policy::CheckpointPolicy;
pub(crate) use checkpoint_policy::{Checkpointer, NoCheckpoints};
pub(crate) use course::{Counts, Course};
pub(crate) use engine::{EXCLUSION_PASSES, Engine, Proposal};
pub(crate) use history::History;
pub(crate) use named::Named;
pub use objectives::Objectives;

pub use plan::Plan;
pub(crate) use progress::GoesOn;
pub use progress::{Observer, Phase, Progress};
pub(crate) use saved::{CPU, EngineState, PeriodState, Saved};
pub(crate) use shape_guard::{set_guards, worst_movable};
pub(crate) use stop::{JITTER, MIN_SCALE, NOISE, ROUNDING};
pub use stop::{Stop, StopRule};
pub use sweep_params::SweepParams;
pub use sweeps::Stepwise;
pub(crate) use sweeps::StepwiseRun;
#[cfg(feature = "gpu")]
pub(crate) use work::Ending;
pub(crate) use work::Work;
