//! Files on disk: the bytes of a mesh with its companion files, and the safe replacement of whole files.

#[cfg(test)]
mod faults;
pub(crate) mod paths;
pub(crate) mod replace;
pub(crate) mod source;
pub(crate) mod stamp;
pub(crate) mod system;
