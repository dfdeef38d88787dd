//! Calls of wgpu whose failures become errors, at once or, in a browser, later.

mod calls;
#[cfg(any(target_arch = "wasm32", test))]
mod reports;
mod watched;

pub(crate) use calls::{caught, check_alive, poll, scoped, scoped_to_buffer};
pub(crate) use watched::WatchedDevice;
