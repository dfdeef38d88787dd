//! A mesh on a device: its buffers, and how they are bound where a device binds less at once.

mod buffers;
mod parts;

pub(crate) use buffers::MeshBuffers;
pub(crate) use parts::{Parts, RingPart, of_part};
