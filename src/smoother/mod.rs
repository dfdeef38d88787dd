//! A prepared mesh, and its runs.

mod backend;
mod calls;
mod goal;
#[cfg(feature = "gpu")]
mod on_device;
mod prepared;
mod running;
mod stages;

pub use backend::Backend;
pub use calls::smooth;
pub use prepared::Smoother;
