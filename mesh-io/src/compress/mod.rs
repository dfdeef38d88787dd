//! Compressed files: what gzip and Zstandard hold, with limits on the size.

pub(crate) mod file;
pub(crate) mod zlib;
