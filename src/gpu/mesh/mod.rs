//! A mesh on a device: its buffers, and how they are bound where they are larger than a binding.

mod buffers;
mod changes;
mod parts;

pub(crate) use buffers::MeshBuffers;
pub(crate) use changes::Changes;
pub(crate) use parts::{Parts, RingPart, of_part};
