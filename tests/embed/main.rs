//! The library inside an application: on its device, in its encoders, on its vertex buffers.
//!
//! Every test makes a device as an application would, and fails if an error that is the library's own to
//! handle reaches the application's handler; see [`app::App`].

#[path = "../support/mod.rs"]
mod support;

mod app;
mod budget;
mod clamped;
mod corrected;
#[cfg(target_os = "linux")]
mod drivers;
mod exchange;
mod futures;
mod inverted;
mod judged;
mod last_valid;
mod limits;
mod lost;
mod objective;
mod parts;
mod passes;
mod pins;
mod readback;
mod refusals;
mod sweeps;
mod targets;
mod timestamps;
mod untangling;
