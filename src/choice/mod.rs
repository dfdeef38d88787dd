//! Chooses the backend that is estimated to smooth a mesh soonest.

mod auto;
#[cfg(feature = "gpu")]
mod estimate;
mod reason;

pub use reason::Reason;
