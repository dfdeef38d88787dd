//! Chooses the backend that is estimated to smooth a mesh soonest.

mod auto;
#[cfg(feature = "gpu")]
mod estimate;
#[cfg(feature = "gpu")]
mod kept;
mod reason;

pub use auto::BackendChooser;
pub use reason::BackendReason;
