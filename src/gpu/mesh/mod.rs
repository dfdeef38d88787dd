//! A mesh on a device: buffers, the parts in which large buffers are bound, and counters of changes.

pub(crate) mod bounds;
mod buffers;
mod changes;
mod curves;
mod parts;

pub(crate) use buffers::MeshBuffers;
pub(crate) use changes::Changes;
pub(crate) use curves::Curves;
pub(crate) use parts::{ElementPart, Parts, RingPart, of_part};
