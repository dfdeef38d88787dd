//! Adapters and devices: limits, arithmetic, buffers and readback.

mod adapters;
mod arithmetic;
pub(crate) mod buffers;
mod gpu;
pub(crate) mod limits;
mod open;
pub(crate) mod pending;
pub(crate) mod readback;
pub(crate) mod size;

pub use adapters::adapters;
pub(crate) use adapters::ranked_adapters;
pub use gpu::Gpu;
pub use open::checked_adapters;
pub use pending::Pending;
pub(crate) use pending::Waiting;
