//! A mesh on a device: its buffers, and how they are bound where they are larger than a binding.

mod buffers;
mod parts;

pub(crate) use buffers::MeshBuffers;
pub(crate) use parts::{Parts, RingPart, of_part};
