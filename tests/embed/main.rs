//! The library inside an application, with the application's device, encoders and vertex buffers.
//!
//! Each test creates a device in the way of an application. A test fails if the application's error
//! handler receives an error that the library must handle; see [`app::App`].

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
mod quadrilaterals;
mod readback;
mod refusals;
mod sliding;
mod sphere;
mod sweeps;
mod targets;
mod timestamps;
mod untangling;
