//! Compressed files: what gzip and Zstandard hold, with limits on the size.

pub(crate) mod packed;
pub(crate) mod zlib;
