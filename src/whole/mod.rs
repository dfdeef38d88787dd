//! Whole runs: sweeps on one engine or on several in turn, the evaluation of target fields between the sweeps, and the improvement of the worst
//! triangles after the last sweep.

pub(crate) mod altitude;
mod any_engine;
mod bounds;
#[cfg_attr(not(feature = "gpu"), path = "no_device.rs")]
mod device;
mod driver;
mod end;
mod improving;
mod patience;
mod place;
mod relief;
mod session;
mod target_field;

pub(crate) use bounds::{bounded, radii};
pub(crate) use device::Device;
pub(crate) use driver::drive;
pub(crate) use end::RunEnd;
pub(crate) use improving::Improvement;
pub(crate) use place::Place;
pub(crate) use session::{Session, Spec};
pub(crate) use target_field::{TargetFieldStage, set_targets_of};
