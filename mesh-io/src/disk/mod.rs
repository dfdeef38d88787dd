//! Files on disk: the bytes of a mesh with its companion files, and the safe replacement of whole files.

pub(crate) mod atomic;
#[cfg(test)]
mod faults;
pub(crate) mod file_system;
pub(crate) mod paths;
pub(crate) mod source;
pub(crate) mod stamp;
