//! Calls of wgpu whose failures become errors, at once or, in a browser, later, and counts of the calls.

mod calls;
mod counts;
mod queue;
#[cfg(any(target_arch = "wasm32", test))]
mod reports;
mod watched;

pub(crate) use calls::{caught, check_alive, poll, scoped, scoped_to_buffer};
pub use counts::DeviceCounts;
pub(crate) use counts::{Count, Counters};
pub(crate) use queue::CountedQueue;
pub(crate) use watched::WatchedDevice;
