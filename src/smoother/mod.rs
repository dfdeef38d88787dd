//! A prepared mesh, and its runs.

mod backend;
mod floor;
mod goal;
mod in_plane;
mod judging;
mod large_angles;
mod moved;
#[cfg(feature = "gpu")]
mod on_device;
mod over_all;
mod prepared;
mod rounds;
mod run;
mod running;
mod slivers;

pub use backend::Backend;
pub use prepared::Smoother;
pub use run::{Run, smooth};
