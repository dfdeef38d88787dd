//! SU2 meshes: the reader, the motions of periodic boundaries, and the writer.

pub(crate) mod motions;
pub(crate) mod read;
pub(crate) mod write;
